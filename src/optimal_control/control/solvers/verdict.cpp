// Tests whether a result of SolverDDP is optimal, and continues from a result that is not optimal.

#include <limits>

#include "../constrained/kkt_residual.hpp"
#include "manycontact/control/fit.hpp"
#include "manycontact/control/ddp.hpp"

namespace manycontact {

using Vectors = std::vector<Eigen::VectorXd>;

namespace {

// Returns the KKT residual with least-squares multipliers. Nodes must have been differentiated at xs, us.
double kkt_residual_of(const ShootingProblem& problem, const Vectors& xs, const Vectors& us, bool limits,
                       double scale) {
  Eigen::VectorXd work;
  return internal::kkt_residual_of_nodes(
      problem, xs, us, internal::least_squares_multipliers_of_nodes(problem, us, limits), limits, {}, scale, work);
}

// Returns the accepted excess of the cost over the optimum within limits: min(th_stop, 1e-9), but not below `rounding`.
double optimality_gap(double th_stop, double rounding) { return std::max(std::min(th_stop, 1e-9), rounding); }

struct Restore {  // restores a number at the end of the scope
  double &number, value;
  ~Restore() { number = value; }
};

}  // namespace

// Decides by the KKT residual whether a candidate without an accepted step is optimal. Cost reductions below the cost's
// rounding error cannot be tested.
StopReason SolverDDP::judgeWithoutStep() {
  problem_->calc(xs_, us_);  // the nodes' data belong to the last, rejected trial step
  calcDiff();
  kkt_ = kkt_residual_of(*problem_, xs_, us_, false, kkt_scale_);
  return kkt_ <= th_kkt_ ? StopReason::kConverged : StopReason::kNoStep;
}

// Returns whether the reduction expected at the least regularisation is below th_stop. A larger one shortens steps.
bool SolverDDP::stopsUnregularised() {
  if (!judges_ || preg_ <= reg_min_ * scale_) return true;
  const double preg = preg_, dreg = dreg_;
  preg_ = dreg_ = reg_min_ * scale_;
  if (!stepped_) problem_->calc(xs_, us_);  // the nodes' data belong to the last, rejected trial step
  const bool stops =
      findDirection(true) &&
      expectedReduction() < std::max(th_stop_ * scale_, 100 * std::numeric_limits<double>::epsilon() * std::abs(cost_));
  preg_ = preg;
  dreg_ = dreg;
  return stops;
}

// Returns whether the expected reduction is below optimality_gap. It is half g^T Quu^-1 g, where g is the gradient with
// respect to the feed-forward terms, projected onto the limits. Returns false for a regularised direction, because its
// larger Quu makes this value too small.
bool SolverDDP::isOptimalWithinLimits() {
  if (preg_ > reg_min_ * scale_) return false;
  problem_->calc(xs_, us_);
  problem_->calcDiff(xs_, us_);
  for (std::size_t t = 0; t < us_.size(); ++t) us_try_[t] = us_[t];
  allocateDescent();
  computeFeedForwardGradient(g_);
  for (std::size_t t = 0; t < us_.size(); ++t) nu_[t] = g_[t];
  preconditionFeedForward(nu_);
  const double rounding = std::numeric_limits<double>::epsilon() * std::abs(cost_) / scale_;
  return 0.5 * dot(g_, nu_) < optimality_gap(th_stop_, rounding) * scale_;
}

// Continues with `descend`, whose gradient is exact. Directions of Crocoddyl's box rule may not descend, because
// expected improvement and value function do not include how far clamped controls move.
StopReason SolverDDP::descendWithinLimits(std::size_t maxiter) {
  const Restore restore{th_stop_, th_stop_};
  if (!stepped_) problem_->calc(xs_, us_);  // the nodes' data belong to the last, rejected trial step
  const bool by_kkt = std::isfinite(th_kkt_), by_gap = judges_ && !by_kkt;
  const double rounding = std::numeric_limits<double>::epsilon() * std::abs(cost_) / scale_;
  constexpr int kRounds = 20, kIdle = 3;  // most rounds of one backward pass each, most in a row without gain
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0, idle = 0; round < kRounds && idle < kIdle; ++round) {
    if (by_kkt) th_stop_ = std::max(1e-6 * restore.value * std::min(1.0, kkt_scale_ / scale_), rounding);
    if (by_gap) th_stop_ = optimality_gap(restore.value, rounding);
    preg_ = dreg_ = reg_min_ * scale_;
    const StopReason reason = descend(maxiter - std::min(maxiter, reported_));
    if (reason == StopReason::kInterrupted || reason == StopReason::kNoDirection) return reason;
    if (!by_kkt && (!by_gap || reason == StopReason::kConverged)) return reason;
    if (by_kkt) {
      problem_->calc(xs_, us_);
      calcDiff();
      kkt_ = kkt_residual_of(*problem_, xs_, us_, true, kkt_scale_);
      if (kkt_ <= th_kkt_) return StopReason::kConverged;
    }
    if (reason == StopReason::kIterations) return reason;
    const double left = by_gap ? stop_ : kkt_;
    idle = left < 0.5 * least ? 0 : idle + 1;
    least = std::min(least, left);
  }
  return StopReason::kNoStep;
}

// Continues from a candidate that met th_stop. Accepts steps whose reduction is below the cost's rounding error.
StopReason SolverDDP::polish(std::size_t maxiter) {
  const Restore restore{th_grad_, th_grad_};
  th_grad_ = std::max(th_grad_, 100 * std::numeric_limits<double>::epsilon() * std::abs(cost_) / scale_);
  for (bool moved = true;; ++polishing_) {
    if (moved) {
      calcDiff();
      kkt_ = kkt_residual_of(*problem_, xs_, us_, keeps_limits(), kkt_scale_);
    }
    if (kkt_ <= th_kkt_) return StopReason::kConverged;
    if (polishing_ == maxiter) return StopReason::kIterations;
    if (!findDirection(false)) return StopReason::kNoDirection;
    moved = searchLine();
    if (!adaptRegularization()) return StopReason::kNoStep;
  }
}

void SolverDDP::limitGuess() {
  if (!keeps_limits()) return;
  for (std::size_t t = 0; t < us_.size(); ++t) {
    const ActionModelAbstract& model = *problem_->model(t);
    if (!model.get_has_control_limits()) continue;
    us_try_[t] = us_[t].cwiseMax(model.get_u_lb()).cwiseMin(model.get_u_ub());
    if (us_try_[t] == us_[t]) continue;
    us_[t] = us_try_[t];
    is_feasible_ = false;
  }
}

// Makes the simulation of the guess's controls the candidate, if no step from a candidate with gaps was accepted. Such
// steps ignore the limits, while steps from a simulated motion, which has no gaps, include them.
bool SolverDDP::rollOutCandidate() {
  if (!keeps_limits() || is_feasible_) return false;
  for (std::size_t t = 0; t < us_.size(); ++t) us_try_[t] = us_guess_[t];
  problem_->rollout(us_try_, xs_try_);
  cost_try_ = problem_->total_cost();
  for (const Eigen::VectorXd& x : xs_try_)
    if (raiseIfNaN(cost_try_) || !internal::is_sound(x)) return false;
  setCandidate(xs_try_, us_try_, true);
  cost_ = cost_try_;
  preg_ = dreg_ = reg_min_ * scale_;
  steplength_ = 1;
  return stepped_ = rolled_out_ = true;
}

}  // namespace manycontact
