// Minimises the violation of the constraints without the costs, to find whether they can be satisfied. Here r are the
// violations, C is their Jacobian, and `stop` is the expected reduction of a step (augmented_lagrangian.hpp).

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "manycontact/control/fit.hpp"
#include "kkt_residual.hpp"
#include "manycontact/control/augmented_lagrangian.hpp"
#include "manycontact/sparse/largest.hpp"

namespace manycontact {

using AL = SolverAugmentedLagrangian;
using Index = Eigen::Index;
using internal::largest_number;

namespace {

constexpr double kAbsurd = 3e8;      // a motion is discarded above this multiple of the cost before the restoration
constexpr double kWorthless = 1e-6;  // a step or search that reduces |r|^2 by at most this share counts as useless
constexpr double kLevel = 1e-6;      // violations r with Jacobian C are stationary if |C^T r| <= kLevel |C| |r|
constexpr double kCrawling = 1e-9;   // iterations are slow if the expected reduction is below this share of |r|^2 / 2
// Largest random changes of the controls for motions near the candidate, relative to max(1, largest control). The small
// changes are for unstable robots, which without feedback move far away from the candidate after larger changes.
constexpr double kBeside[] = {1e-2, 1e-4, 1e-6};
// Largest random changes of the controls for motions far from the candidate, relative to max(1, largest control).
// Negative: changes of zero controls.
constexpr double kElsewhere[] = {0.3, -0.1, 1, -0.5, 3, -2, 0.05, 0.2};
constexpr double kRegularised = 1e-12;  // least regularisation, in units of min(|C|^2, 1)
constexpr double kCreeping = 0.99;  // a search ends if kCreepingWindow iterations leave at least this share of |r|^2
constexpr double kSettled = 1 - 1e-12;  // kCreeping for quasi-Newton steps, which end when they no longer reduce |r|^2
constexpr std::size_t kCreepingWindow = 8;
constexpr double kAsNear = 1.01;  // if infeasible, the original candidate is kept up to this multiple of the violation
constexpr double kMuchNearer = 0.5;  // the solve continues if at most this share of the original violation is left
constexpr std::size_t kMostIterations = 500;
constexpr std::size_t kMostLevelling = 50;
constexpr int kLevellings = 50, kIdleLevellings = 12;
// Initial regularisation of quasi-Newton steps, in units of |C|^2, and the factor by which it increases.
constexpr double kLeastLevelling = 1e-4, kMoreRegularised = 10;
constexpr double kLongest = 10;  // longest first quasi-Newton step, in units of the largest control
constexpr double kBack = 1e-3;  // a search has returned to the candidate if |r|^2 is larger there by at most this share
constexpr std::size_t kRestorations = 5;
constexpr double kBeyond = 0.1;  // infeasible: controls within limits reduce |r|^2 by at most this share
constexpr int kSaddles = 4;  // most searches that restart from a smaller violation near the candidate

}  // namespace

// Ends a minimisation of the violation when it makes no progress, or when the constraints are met.
class AL::Watch : public CallbackAbstract {
 public:
  Watch(SolverAugmentedLagrangian& outer, double met) : outer_(outer), met_(met) {}
  void operator()(SolverAbstract& solver) override {
    const double left = solver.get_cost();
    slow_ = searches_ && solver.get_is_feasible() && solver.get_stop() < kCrawling * left ? slow_ + 1 : 0;
    if (last_.empty() || left != last_.back())
      last_.push_back(left);  // a rejected step reports the same violation again
    const double most = searches_ ? kCreeping : kSettled;
    const bool creeps = last_.size() > kCreepingWindow && left > most * last_[last_.size() - 1 - kCreepingWindow];
    if (outer_.reportRestoration(solver) || left <= met_ || slow_ == 3 || creeps) solver.interrupt();
  }
  /// Resets the counts of slow iterations. searches: the minimisation ends when it converges slowly, otherwise only
  /// when it no longer reduces the violation.
  void begin(bool searches) {
    slow_ = 0;
    last_.clear();
    searches_ = searches;
  }

 private:
  SolverAugmentedLagrangian& outer_;
  double met_;
  int slow_ = 0;
  bool searches_ = true;
  std::vector<double> last_;  // squared violations
};

// Reports an iteration to the callbacks. Returns whether the solve was interrupted.
bool AL::reportRestoration(const SolverAbstract& solver) {
  merit_ = solver.get_cost();
  stop_ = solver.get_stop();
  iter_ = reported_;
  preg_ = solver.get_preg();
  steplength_ = solver.get_steplength();
  ffeas_ = solver.get_ffeas();
  is_feasible_ = solver.get_is_feasible();
  callCallbacks();
  return interrupted_;
}

// A problem with the same nodes, whose only cost is half the squared violation |r|^2, and the solver that minimises it.
struct AL::Restoration {
  std::vector<Augmented> augmented;
  std::shared_ptr<ShootingProblem> problem;
  std::shared_ptr<SolverDDP> solver;
  std::shared_ptr<Watch> watch;
  bool rests = false;  // whether quasi-Newton steps ended at a stationary candidate
  std::size_t last;    // number of reported iterations at which the search ends
};

// Creates the problem that minimises the violation. The constraints are met if half of |r|^2 is at most `met`.
AL::Restoration AL::violationAlone(double met, std::size_t maxiter) {
  Restoration out;
  out.last = maxiter;
  ShootingProblem::Models models;
  ShootingProblem::Datas datas;
  augments_all_ = true;
  for (std::size_t t = 0; t < nodes_.size(); ++t) {
    const Copy copy =
        augment(nodes_[t].own, problem_->by_state_alone(t), internal::range(0, static_cast<int>(nodes_[t].rows)),
                Eigen::VectorXd::Zero(nodes_[t].rows), out.augmented);
    models.push_back(copy.model);
    datas.push_back(copy.data);
  }
  augments_all_ = false;
  for (const Augmented& own : out.augmented) {
    own.model->set_with_cost(false);
    own.model->set_penalty(1);
  }
  const Copy last{models.back(), datas.back()};
  models.pop_back();
  datas.pop_back();
  out.problem = std::make_shared<ShootingProblem>(problem_->get_x0(), models, last.model, datas, last.data);
  out.problem->set_nthreads(static_cast<int>(problem_->get_nthreads()));
  out.solver = make_(out.problem);
  out.solver->set_judges(false);
  out.solver->set_reg_min(kRegularised);
  out.solver->set_th_grad(met);
  out.solver->set_th_stop(1e-3 * met);
  out.watch = std::make_shared<Watch>(*this, met);
  out.solver->setCallbacks({out.watch});
  return out;
}

// Sets the least regularisation in proportion to |C|^2: an absolute one prevents steps if controls have weak effects.
void AL::regulariseLeast(Restoration& own) {
  evaluate(own);
  const double size = jacobianSize(own);
  constexpr double kSmallest = std::numeric_limits<double>::epsilon();  // used if |C| is zero or NaN
  own.solver->set_reg_min(kRegularised * std::min(1.0, std::max(kSmallest, size * size)));
}

// Minimises the violation from the candidate, and makes the result the candidate. If Gauss-Newton steps do not end at a
// stationary point, for example near a stretched arm, continues with quasi-Newton steps, which include the curvature.
void AL::leastViolation(Restoration& own) {
  own.rests = false;
  own.watch->begin(true);
  (void)own.solver->solve(xs_, us_, std::min(kMostIterations, own.last - reported_), is_feasible_);
  take(own);
  if (interrupted_ || !is_feasible_ || violation_ <= th_constraint_ || isStationary(own)) return;
  level(own);
}

// Takes quasi-Newton steps from a candidate without gaps until the candidate is stationary. Each round starts from the
// Gauss-Newton Hessian. The regularisation increases after a round that does not reduce the violation.
void AL::level(Restoration& own) {
  own.rests = false;
  const double size = jacobianSize(own);
  (void)own.problem->calcDiff(xs_, us_);
  const double gradient = internal::control_gradient_of_nodes(*own.problem, us_, own.solver->keeps_limits());
  double regularisation = std::max(kLeastLevelling * size * size, gradient / (kLongest * largest_number(us_)));
  for (int round = 0, idle = 0; round < kLevellings && idle < kIdleLevellings; ++round) {
    if (!(regularisation > 0)) regularisation = kRegularised;
    own.watch->begin(false);
    own.solver->setCandidate(xs_, us_, true);
    own.solver->set_preg(regularisation);
    const double before = merit_;
    const StopReason reason = own.solver->descend(std::min(kMostLevelling, own.last - reported_));
    take(own);
    if (interrupted_ || violation_ <= th_constraint_) return;
    if (reason == StopReason::kNoDirection || !std::isfinite(merit_)) return;
    own.rests = violationSlope(own) <= kLevel;
    if (own.rests || reason == StopReason::kIterations) return;
    const bool falls = merit_ < kCreeping * before;
    idle = falls ? 0 : idle + 1;
    if (!falls) regularisation *= kMoreRegularised;
  }
}

void AL::take(Restoration& own) {
  for (std::size_t t = 0; t < xs_.size(); ++t) xs_[t] = own.solver->get_xs()[t];
  for (std::size_t t = 0; t < us_.size(); ++t) us_[t] = own.solver->get_us()[t];
  is_feasible_ = own.solver->get_is_feasible();
  evaluate(own);
}

// Searches for a smaller violation, from a motion with other controls. These are the candidate's controls, or zeros if
// `by` is negative, plus random numbers of up to |by| times max(1, largest control). If the search ends at a smaller
// violation, its result becomes the candidate. Near the candidate only quasi-Newton steps are taken, because
// Gauss-Newton steps may return to a maximum or a saddle. If the quasi-Newton steps return to the candidate, the
// candidate is a minimum.
AL::Beside AL::lookBeside(Restoration& own, double by) {
  const std::vector<Eigen::VectorXd> xs = xs_, us = us_;
  const double merit = merit_;
  const double largest = largest_number(us_);
  std::mt19937 random(static_cast<unsigned>(100 * std::abs(by)));
  std::uniform_real_distribution<double> noise(-std::abs(by) * largest, std::abs(by) * largest);
  Eigen::VectorXd throughout = Eigen::VectorXd::Zero(problem_->get_nu_max());
  const bool beside = std::abs(by) <= kBeside[0];
  if (!beside)  // adds constant controls: effects of controls that vary by node would cancel
    for (double& number : throughout) number = noise(random);
  for (std::size_t t = 0; t < us_.size(); ++t) {
    if (by < 0) us_[t].setZero();
    us_[t] += throughout.head(us_[t].size());
    for (double& number : us_[t]) number += noise(random);
    if (own.solver->keeps_limits()) internal::keep_limits(*problem_->model(t), us_[t]);
  }
  own.problem->rollout(us_, xs_);
  is_feasible_ = true;
  const bool is_motion = std::isfinite(own.problem->calc(xs_, us_));
  if (is_motion && beside) level(own);
  if (is_motion && !beside) leastViolation(own);
  if (is_motion && merit_ < merit * (1 - kWorthless)) return Beside::kFalls;
  const bool comes_back = is_motion && merit_ < merit * (1 + kBack);
  xs_ = xs;
  us_ = us;
  is_feasible_ = true;
  evaluate(own);
  return comes_back ? Beside::kComesBack : Beside::kUnclear;
}

void AL::evaluate(Restoration& own) {
  merit_ = own.problem->calc(xs_, us_);
  collectParts();
  cost_ = problem_->total_cost();
  measureViolation();
}

// Estimates |C|, the norm of the Jacobian of the violated rows with respect to the controls (states by simulation). For
// random combinations w of the rows, |C^T w|^2 is on average at least a third of |C|^2.
double AL::jacobianSize(Restoration& own) {
  constexpr int kDraws = 4;
  constexpr double kNoPenalty = 1e-100;  // so small that the gradient of the augmented Lagrangian is C^T w
  std::vector<Eigen::VectorXd> signs;    // signs of the violations
  for (const Augmented& part : own.augmented) signs.push_back(part.data->y_next.cwiseSign());
  std::mt19937 random(2);
  std::uniform_real_distribution<double> share(0, 2);  // not negative: the multiplier of an inequality has a fixed sign
  double squares = 0;
  for (int k = 0; k < kDraws; ++k) {
    for (std::size_t i = 0; i < signs.size(); ++i) {
      Eigen::VectorXd w = signs[i];
      for (double& number : w) number *= share(random);
      own.augmented[i].model->set_penalty(kNoPenalty);
      own.augmented[i].model->set_multipliers(w);
    }
    (void)own.problem->calc(xs_, us_);
    (void)own.problem->calcDiff(xs_, us_);
    const double of_w = internal::control_gradient_of_nodes(*own.problem, us_, false);
    squares += of_w * of_w / kDraws;
  }
  for (std::size_t i = 0; i < signs.size(); ++i) {
    own.augmented[i].model->set_penalty(1);
    own.augmented[i].model->set_multipliers(Eigen::VectorXd::Zero(signs[i].size()));
  }
  evaluate(own);
  return std::sqrt(3 * squares);
}

// Returns |C^T r| / (|C| |r|), where r are the violations.
double AL::violationSlope(Restoration& own) {
  evaluate(own);
  (void)own.problem->calcDiff(xs_, us_);
  const double of_r = internal::control_gradient_of_nodes(*own.problem, us_, own.solver->keeps_limits());
  return of_r == 0 ? 0 : of_r / (jacobianSize(own) * std::sqrt(2 * merit_));
}

// Returns whether the violations r are stationary: the last quasi-Newton steps ended with C^T r small relative to |C|
// |r|, or a step of the linearised problem is predicted to reduce |r|^2 only by a small share. The first test also
// detects a stretched arm. The second test also works if the singular values of C differ much.
bool AL::isStationary(Restoration& own) {
  SolverDDP& solver = *own.solver;
  solver.setCandidate(xs_, us_, is_feasible_);
  solver.set_preg(solver.get_reg_min());
  solver.computeDirection(true);
  if (!is_feasible_ || !solver.direction_is_sound()) return false;
  return solver.expectedReduction() <= kWorthless * merit_ || own.rests;
}

// Returns whether no controls within their limits reduce the squared violation by more than a small share, to first
// order around the candidate or zero controls. For linear motions this bounds the least violation (Frank-Wolfe gap).
bool AL::isBeyondLimits(Restoration& own) {
  if (!own.solver->keeps_limits()) return false;
  const std::vector<Eigen::VectorXd> xs = xs_, us = us_;
  const auto is_beyond = [&] {
    own.problem->rollout(us_, xs_);
    evaluate(own);
    (void)own.problem->calcDiff(xs_, us_);
    return internal::largest_fall_within_limits(*own.problem, us_) < kBeyond * merit_;
  };
  bool out = is_beyond();
  if (!out) {
    for (std::size_t t = 0; t < us_.size(); ++t) {
      us_[t].setZero();
      internal::keep_limits(*problem_->model(t), us_[t]);
    }
    out = is_beyond();
  }
  xs_ = xs;
  us_ = us;
  evaluate(own);
  return out;
}

// Returns whether the motion is an affine function of the controls between `us_before` and the candidate's controls.
// This is tested at the midpoint. For affine motions a large cost is accepted.
bool AL::movesInLineFrom(const Vectors& us_before) {
  constexpr double kInLine = 1e-6;  // largest deviation of the midpoint, relative to the distance of the two motions
  std::vector<Eigen::VectorXd> us = us_, xs = xs_, xs_before = xs_, xs_after = xs_;
  for (std::size_t t = 0; t < us.size(); ++t) us[t] = 0.5 * (us_[t] + us_before[t]);
  problem_->rollout(us_before, xs_before);
  problem_->rollout(us_, xs_after);
  problem_->rollout(us, xs);
  const StateAbstract& state = *problem_->get_terminalModel()->get_state();
  Eigen::VectorXd half = Eigen::VectorXd::Zero(state.get_ndx()), whole = half;
  double off = 0, far = 0;
  for (std::size_t t = 0; t < xs.size(); ++t) {
    state.diff(xs_before[t], xs[t], half);
    state.diff(xs_before[t], xs_after[t], whole);
    off = sparse::larger_or_nan((half - 0.5 * whole).lpNorm<Eigen::Infinity>(), off);
    far = sparse::larger_or_nan(whole.lpNorm<Eigen::Infinity>(), far);
  }
  return off <= kInLine * far;
}

// Minimises the violation. Returns kInfeasible if the violation is not zero, and is a minimum (according to C^T r and
// to searches from nearby motions) or cannot be much reduced within control limits. Returns kNone if the solve may
// continue, from a candidate that meets the constraints or violates them much less. Otherwise returns kNoStep.
StopReason AL::restore(std::size_t maxiter) {
  if (++restorations_ > kRestorations) return StopReason::kNoStep;
  const double met = 0.5 * th_constraint_ * th_constraint_;
  Restoration own = violationAlone(met, std::max(maxiter, reported_));
  const auto take_back = [&](const Vectors& xs, const Vectors& us, bool feasible) {
    xs_ = xs;
    us_ = us;
    is_feasible_ = feasible;
    evaluate(own);
  };
  const std::vector<Eigen::VectorXd> xs_before = xs_, us_before = us_;
  const double cost_before = cost_, violation_before = violation_;
  const bool feasible_before = is_feasible_;
  const auto is_large = [&] { return !(cost_ <= kAbsurd * (std::abs(cost_before) + scale_)); };
  const auto is_absurd = [&] { return is_large() && !(std::isfinite(cost_) && movesInLineFrom(us_before)); };
  const auto goes_on = [&] { return violation_ > th_constraint_ && !interrupted_ && reported_ < maxiter; };
  const bool beyond = isBeyondLimits(own);
  regulariseLeast(own);
  leastViolation(own);
  if (is_absurd() && feasible_before && goes_on()) {  // tries again with moderate steps
    take_back(xs_before, us_before, true);
    level(own);
  }
  bool shown = false;
  // A stationary point may be a maximum, a saddle or a larger minimum, and a search may end before it is stationary.
  for (int k = 0; goes_on() && k <= kSaddles; ++k) {
    if (k > 0) leastViolation(own);
    const bool stationary = isStationary(own);
    Beside beside = Beside::kUnclear;
    for (const double by : kBeside)
      if (stationary && beside == Beside::kUnclear && goes_on()) beside = lookBeside(own, by);
    bool falls = beside == Beside::kFalls;
    for (const double by : kElsewhere)
      falls = falls || (k < kSaddles && goes_on() && lookBeside(own, by) == Beside::kFalls);
    shown = !falls && beside == Beside::kComesBack;
    if (!falls) break;
  }
  if (interrupted_) return StopReason::kInterrupted;
  // A violation below `shows` is only the rounding error of squared numbers, and does not prove infeasibility.
  const double shows = std::sqrt(std::numeric_limits<double>::epsilon()) * largest_number(xs_);
  shown = shown || (beyond && violation_ > kMuchNearer * violation_before);
  if (shown && violation_ > std::max(th_constraint_, shows)) {
    if (feasible_before && violation_before <= kAsNear * violation_) take_back(xs_before, us_before, true);
    return StopReason::kInfeasible;
  }
  // The original motion becomes the candidate again in two cases. Either the torques are so large that integration
  // errors open the contacts, or the violation increased although nothing else was minimised.
  const bool absurd = is_absurd();
  const bool nearer = violation_ <= std::max(th_constraint_, kMuchNearer * violation_before);
  if (absurd || violation_ > violation_before) take_back(xs_before, us_before, false);
  if (absurd || !nearer) return reported_ >= maxiter ? StopReason::kIterations : StopReason::kNoStep;
  if (is_large()) takeCostOf(violation_before);
  return reported_ >= maxiter ? StopReason::kIterations : StopReason::kNone;
}

// Sets the scale of the cost to the candidate's large cost, and sets a penalty that outweighs this cost. violation: the
// violation before the restoration, which a minimisation of the cost alone leaves.
void AL::takeCostOf(double violation) {
  constexpr double kOrdinary = 1e4;  // largest cost for which th_stop and th_kkt need no scaling
  const double of_cost = std::exp2(std::round(std::log2(std::abs(cost_) / kOrdinary)));
  scale_ = std::max(scale_, of_cost);
  kkt_scale_ = std::max(kkt_scale_, of_cost);
  inner_->set_scale(scale_);
  set_penalty(std::max(rho_, 2 * std::abs(cost_) / (violation * violation)));
}

// Resets multipliers and convergence tests, and increases the penalty, to continue the solve from the candidate.
void AL::startAgain() {
  for (const Node& node : nodes_)
    for (const Augmented& own : node.augmented) own.model->set_multipliers(Eigen::VectorXd::Zero(own.rows.size()));
  set_penalty(std::min(rho_ * rho_factor_ * rho_factor_, rho_max_ * std::max(scale_, kkt_scale_)));
  flat_ = stuck_ = 0;
  curved_ = false;
  failed_stop_ = std::numeric_limits<double>::infinity();
  last_measure_ = last_violation_ = best_kkt_ = std::numeric_limits<double>::infinity();
  tolerance_ = std::max(th_stop_ * scale_, 1e-2 * std::abs(cost_));
}

}  // namespace manycontact
