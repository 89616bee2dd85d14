// The least violation of the constraints, costs left out: whether they can be met at all.

#include <algorithm>
#include <random>
#include <vector>

#include "manycontact/control/augmented_lagrangian.hpp"

namespace manycontact {

using AL = SolverAugmentedLagrangian;

namespace {

constexpr double kAbsurd = 1e9;      // times the cost at hand: no motion that a solve may go on from
constexpr double kWorthless = 1e-6;  // of the squared violation, what a step may take off at a least one
constexpr double kCrawling = 1e-9;   // at which iterations end
constexpr double kBeside = 1e-2;     // of the largest control, or of 1: where it is tried again
constexpr double kRegularised = 1e-12;
constexpr double kCreeping = 0.99;  // of the squared violation, what kCreepingWindow iterations of a slow search leave
constexpr std::size_t kCreepingWindow = 8;
constexpr double kMuchNearer = 0.5;  // of the violation: worth going on from
constexpr std::size_t kMostIterations = 500;
constexpr std::size_t kRestorations = 5;

}  // namespace

// Ends the iterations where they gain nothing, and where the constraints are met.
class AL::Watch : public CallbackAbstract {
 public:
  Watch(SolverAugmentedLagrangian& outer, double met) : outer_(outer), met_(met) {}
  void operator()(SolverAbstract& solver) override {
    const double left = solver.get_cost();
    slow_ = solver.get_is_feasible() && solver.get_stop() < kCrawling * left ? slow_ + 1 : 0;
    if (last_.empty() || left != last_.back()) last_.push_back(left);  // else regularised more, and tried again
    const bool creeps = last_.size() > kCreepingWindow && left > kCreeping * last_[last_.size() - 1 - kCreepingWindow];
    if (outer_.reportRestoration(solver) || left <= met_ || slow_ == 3 || creeps) solver.interrupt();
  }

 private:
  SolverAugmentedLagrangian& outer_;
  double met_;
  int slow_ = 0;
  std::vector<double> last_;  // squared violations
};

// Whether a callback asks for an end.
bool AL::reportRestoration(const SolverAbstract& solver) {
  merit_ = solver.get_cost();
  stop_ = solver.get_stop();
  preg_ = solver.get_preg();
  steplength_ = solver.get_steplength();
  ffeas_ = solver.get_ffeas();
  is_feasible_ = solver.get_is_feasible();
  callCallbacks();
  return interrupted_;
}

// The problem's nodes at half their squared violation.
std::shared_ptr<ShootingProblem> AL::violationAlone(std::vector<Augmented>& augmented) const {
  ShootingProblem::Models models;
  ShootingProblem::Datas datas;
  for (std::size_t t = 0; t < nodes_.size(); ++t) {
    std::vector<int> rows(static_cast<std::size_t>(nodes_[t].rows));
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<int>(i);
    const Copy copy =
        augment(nodes_[t].own, problem_->by_state_alone(t), rows, Eigen::VectorXd::Zero(nodes_[t].rows), augmented);
    models.push_back(copy.model);
    datas.push_back(copy.data);
  }
  for (const Augmented& own : augmented) {
    own.model->set_with_cost(false);
    own.model->set_penalty(1);
  }
  const Copy last{models.back(), datas.back()};
  models.pop_back();
  datas.pop_back();
  auto out = std::make_shared<ShootingProblem>(problem_->get_x0(), models, last.model, datas, last.data);
  out->set_nthreads(static_cast<int>(problem_->get_nthreads()));
  return out;
}

// From the candidate, or from beside it; what it ends at is the candidate.
void AL::leastViolation(SolverDDP& solver, ShootingProblem& alone, bool beside, std::size_t most) {
  if (beside) {
    double largest = 1;
    for (const Eigen::VectorXd& u : us_)
      if (u.size() > 0) largest = std::max(largest, u.lpNorm<Eigen::Infinity>());
    std::mt19937 random(1);
    std::uniform_real_distribution<double> noise(-kBeside * largest, kBeside * largest);
    for (Eigen::VectorXd& u : us_)
      for (double& number : u) number += noise(random);
    is_feasible_ = false;
  }
  (void)solver.solve(xs_, us_, most, is_feasible_);
  for (std::size_t t = 0; t < xs_.size(); ++t) xs_[t] = solver.get_xs()[t];
  for (std::size_t t = 0; t < us_.size(); ++t) us_[t] = solver.get_us()[t];
  is_feasible_ = solver.get_is_feasible();
  merit_ = alone.calc(xs_, us_);
  collectParts();
  cost_ = problem_->total_cost();
  measureViolation();
}

// What a step of the linearised problem promises, of what is left: with r the violations, the share of r within the
// range of their Jacobian C, |P_C r|^2 / |r|^2. It is zero where C^T r is.
bool AL::isStationary(SolverDDP& solver) {
  solver.setCandidate(xs_, us_, is_feasible_);
  solver.set_preg(solver.get_reg_min());
  solver.computeDirection(true);
  return is_feasible_ && solver.direction_is_sound() && solver.expectedReduction() <= kWorthless * merit_;
}

// kInfeasible where the least violation is not zero and shown to be one, by C^T r and from beside it as well; kNone
// where a solve may go on, from a candidate that meets the constraints or is much nearer; kNoStep where nothing is
// shown.
StopReason AL::restore(std::size_t maxiter) {
  if (++restorations_ > kRestorations) return StopReason::kNoStep;
  augments_all_ = true;
  std::vector<Augmented> augmented;
  const std::shared_ptr<ShootingProblem> alone = violationAlone(augmented);
  augments_all_ = false;
  const std::shared_ptr<SolverDDP> solver = make_(alone);
  const double met = 0.5 * th_constraint_ * th_constraint_;
  solver->set_reg_min(kRegularised);
  solver->set_th_grad(met);
  solver->set_th_stop(1e-3 * met);
  solver->setCallbacks({std::make_shared<Watch>(*this, met)});
  const auto take_back = [&](const std::vector<Eigen::VectorXd>& xs, const std::vector<Eigen::VectorXd>& us,
                             bool feasible) {
    xs_ = xs;
    us_ = us;
    is_feasible_ = feasible;
    merit_ = alone->calc(xs_, us_);
    collectParts();
    cost_ = problem_->total_cost();
    measureViolation();
  };
  const std::vector<Eigen::VectorXd> xs_before = xs_, us_before = us_;
  const double cost_before = cost_, violation_before = violation_;
  leastViolation(*solver, *alone, false, kMostIterations);
  bool stationary = isStationary(*solver);
  if (stationary && violation_ > th_constraint_) {  // a maximum or a saddle is stationary too
    const std::vector<Eigen::VectorXd> xs = xs_, us = us_;
    const double merit = merit_;
    leastViolation(*solver, *alone, true, kMostIterations);
    stationary = isStationary(*solver);
    if (!(merit_ < merit * (1 - kWorthless))) {
      take_back(xs, us, true);
      stationary = true;
    }
  }
  if (interrupted_) return StopReason::kInterrupted;
  if (violation_ > th_constraint_ && stationary) return StopReason::kInfeasible;
  // Met by a motion that is none (torques so large that the steps no longer hold the contacts), or no nearer although
  // nothing else was asked for: nothing is shown then.
  const bool absurd = !(cost_ <= kAbsurd * (std::abs(cost_before) + scale_));
  const bool nearer = violation_ <= std::max(th_constraint_, kMuchNearer * violation_before);
  if (absurd || violation_ > violation_before) take_back(xs_before, us_before, false);
  if (absurd || !nearer) return StopReason::kNoStep;
  return total_ >= maxiter ? StopReason::kIterations : StopReason::kNone;
}

// From the candidate at hand, under a penalty that holds it nearer to the constraints.
void AL::startAgain() {
  for (const Node& node : nodes_)
    for (const Augmented& own : node.augmented)
      own.model->set_multipliers(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(own.rows.size())));
  set_penalty(std::min(rho_ * rho_factor_ * rho_factor_, rho_max_ * scale_));
  flat_ = stuck_ = 0;
  curved_ = false;
  failed_stop_ = std::numeric_limits<double>::infinity();
  last_measure_ = last_violation_ = best_kkt_ = std::numeric_limits<double>::infinity();
  tolerance_ = std::max(th_stop_ * scale_, 1e-2 * std::abs(cost_));
}

}  // namespace manycontact
