// The least violation of the constraints, costs left out: whether they can be met at all.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "kkt_residual.hpp"
#include "manycontact/control/augmented_lagrangian.hpp"
#include "manycontact/sparse/largest.hpp"

namespace manycontact {

using AL = SolverAugmentedLagrangian;
using Index = Eigen::Index;

namespace {

constexpr double kAbsurd = 3e8;                   // times the cost at hand: no motion that a solve may go on from
constexpr double kWorthless = 1e-6;               // of the squared violation, what a step may take off at a least one
constexpr double kLevel = 1e-6;                   // of |C| |r|, what |C^T r| is there
constexpr double kCrawling = 1e-9;                // at which iterations end
constexpr double kBeside[] = {1e-2, 1e-4, 1e-6};  // of the largest control, or of 1: where it is tried again, nearer
                                                  // where a motion without feedback goes too far
constexpr double kElsewhere[] = {0.3, -0.1, 1, -0.5, 3, -2};  // far from there
constexpr double kRegularised = 1e-12;
constexpr double kCreeping = 0.99;  // of the squared violation, what kCreepingWindow iterations of a slow search leave
constexpr double kSettled = 1 - 1e-12;  // of one that looks for a level place
constexpr std::size_t kCreepingWindow = 8;
constexpr double kAsNear = 1.01;              // of the least violation
constexpr double kMuchNearer = 0.5;           // of the violation: worth going on from
constexpr std::size_t kMostIterations = 500;  // iterations
constexpr std::size_t kMostLevelling = 50;
constexpr int kLevellings = 50, kIdleLevellings = 12;
constexpr double kLeastLevelling = 1e-4, kMoreRegularised = 10;  // of |C|^2; times
constexpr double kLongest = 10;                                  // times the largest control: a first step of it
constexpr double kBack = 1e-3;  // of the squared violation, what a search from beside may leave more
constexpr std::size_t kRestorations = 5;
constexpr int kSaddles = 4;  // places that were stationary, and no least ones

// Of states or controls; or 1.
double largest_number(const std::vector<Eigen::VectorXd>& xs) {
  double out = 1;
  for (const Eigen::VectorXd& x : xs)
    if (x.size() > 0) out = std::max(out, x.lpNorm<Eigen::Infinity>());
  return out;
}

}  // namespace

// Ends the iterations where they gain nothing, and where the constraints are met.
class AL::Watch : public CallbackAbstract {
 public:
  Watch(SolverAugmentedLagrangian& outer, double met) : outer_(outer), met_(met) {}
  void operator()(SolverAbstract& solver) override {
    const double left = solver.get_cost();
    slow_ = searches_ && solver.get_is_feasible() && solver.get_stop() < kCrawling * left ? slow_ + 1 : 0;
    if (last_.empty() || left != last_.back()) last_.push_back(left);  // else regularised more, and tried again
    const double most = searches_ ? kCreeping : kSettled;
    const bool creeps = last_.size() > kCreepingWindow && left > most * last_[last_.size() - 1 - kCreepingWindow];
    if (outer_.reportRestoration(solver) || left <= met_ || slow_ == 3 || creeps) solver.interrupt();
  }
  /// Anew; a search ends where it creeps, else it is to come to rest.
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

// The problem's nodes at half their squared violation, and the search for its least: the violation alone.
struct AL::Restoration {
  std::vector<Augmented> augmented;
  std::shared_ptr<ShootingProblem> problem;
  std::shared_ptr<SolverDDP> solver;
  std::shared_ptr<Watch> watch;
  bool rests = false;  // quasi-Newton steps came to rest at the candidate
};

// met: half the squared violation that is none.
AL::Restoration AL::violationAlone(double met) {
  Restoration out;
  ShootingProblem::Models models;
  ShootingProblem::Datas datas;
  augments_all_ = true;
  for (std::size_t t = 0; t < nodes_.size(); ++t) {
    std::vector<int> rows(static_cast<std::size_t>(nodes_[t].rows));
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<int>(i);
    const Copy copy =
        augment(nodes_[t].own, problem_->by_state_alone(t), rows, Eigen::VectorXd::Zero(nodes_[t].rows), out.augmented);
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

// From the candidate; what it ends at is the candidate. Next to a stretched arm Gauss-Newton's steps promise all of the
// violation, and take off next to nothing: quasi-Newton steps, which see the curvature, come to rest.
void AL::leastViolation(Restoration& own) {
  own.rests = false;
  own.watch->begin(true);
  (void)own.solver->solve(xs_, us_, kMostIterations, is_feasible_);
  take(own);
  if (interrupted_ || !is_feasible_ || violation_ <= th_constraint_ || isStationary(own)) return;
  level(own);
}

// Quasi-Newton steps from a candidate without gaps, until they come to rest: from Gauss-Newton's Hessian, more and more
// regularised where its steps are too long.
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
    const StopReason reason = own.solver->descend(kMostLevelling);
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

// What the search has come to.
void AL::take(Restoration& own) {
  for (std::size_t t = 0; t < xs_.size(); ++t) xs_[t] = own.solver->get_xs()[t];
  for (std::size_t t = 0; t < us_.size(); ++t) us_[t] = own.solver->get_us()[t];
  is_feasible_ = own.solver->get_is_feasible();
  evaluate(own);
}

// From another motion, of controls that differ by up to |by| of the largest one, from zero where it is negative. Where
// that ends at less, it is the candidate; else the candidate stays. Very near it, by steps that only go down:
// Gauss-Newton's would go back to a maximum or a saddle. That it is a least one is shown where these come back to it.
AL::Beside AL::lookBeside(Restoration& own, double by) {
  const std::vector<Eigen::VectorXd> xs = xs_, us = us_;
  const double merit = merit_;
  const double largest = largest_number(us_);
  std::mt19937 random(static_cast<unsigned>(100 * std::abs(by)));
  std::uniform_real_distribution<double> noise(-std::abs(by) * largest, std::abs(by) * largest);
  Eigen::VectorXd throughout = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem_->get_nu_max()));
  const bool beside = std::abs(by) <= kBeside[0];
  if (!beside)  // what changes from node to node goes nowhere
    for (double& number : throughout) number = noise(random);
  for (std::size_t t = 0; t < us_.size(); ++t) {
    if (by < 0) us_[t].setZero();
    us_[t] += throughout.head(us_[t].size());
    for (double& number : us_[t]) number += noise(random);
    const ActionModelAbstract& model = *problem_->model(t);
    if (own.solver->keeps_limits() && model.get_has_control_limits())
      us_[t] = us_[t].cwiseMax(model.get_u_lb()).cwiseMin(model.get_u_ub());
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

// The candidate's violations alone, and the problem's own cost.
void AL::evaluate(Restoration& own) {
  merit_ = own.problem->calc(xs_, us_);
  collectParts();
  cost_ = problem_->total_cost();
  measureViolation();
}

// |C|: of the violated rows' Jacobian by the controls, which the states follow. By random combinations w of the rows,
// for which |C^T w|^2 is on average a third of |C|^2, or more.
double AL::jacobianSize(Restoration& own) {
  constexpr int kDraws = 4;
  constexpr double kNoPenalty = 1e-100;  // y+ = y
  std::vector<Eigen::VectorXd> signs;    // of the violations
  for (const Augmented& part : own.augmented) signs.push_back(part.data->y_next.cwiseSign());
  std::mt19937 random(2);
  std::uniform_real_distribution<double> share(0, 2);  // no other sign: an inequality has one side
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

// |C^T r| / (|C| |r|), r the violations.
double AL::violationSlope(Restoration& own) {
  evaluate(own);
  (void)own.problem->calcDiff(xs_, us_);
  const double of_r = internal::control_gradient_of_nodes(*own.problem, us_, own.solver->keeps_limits());
  return of_r == 0 ? 0 : of_r / (jacobianSize(own) * std::sqrt(2 * merit_));
}

// With r the violations, where C^T r is next to nothing: beside |C| |r|, or by what a step of the linearised problem
// promises to take off, the share of r within the range of C, |P_C r|^2 / |r|^2. (The one is small at a stretched arm
// too, the other where C's directions differ much.)
bool AL::isStationary(Restoration& own) {
  SolverDDP& solver = *own.solver;
  solver.setCandidate(xs_, us_, is_feasible_);
  solver.set_preg(solver.get_reg_min());
  solver.computeDirection(true);
  if (!is_feasible_ || !solver.direction_is_sound()) return false;
  return solver.expectedReduction() <= kWorthless * merit_ || own.rests;
}

// Whether the motion moves in a line as its controls do, from those before to those of the candidate: by the one half
// way. Then numbers may be as large as they are.
bool AL::movesInLineFrom(const std::vector<Eigen::VectorXd>& us_before) {
  constexpr double kInLine = 1e-6;  // of how far it moves
  std::vector<Eigen::VectorXd> us = us_, xs = xs_, xs_before = xs_, xs_after = xs_;
  for (std::size_t t = 0; t < us.size(); ++t) us[t] = 0.5 * (us_[t] + us_before[t]);
  problem_->rollout(us_before, xs_before);
  problem_->rollout(us_, xs_after);
  problem_->rollout(us, xs);
  const StateAbstract& state = *problem_->get_terminalModel()->get_state();
  Eigen::VectorXd half = Eigen::VectorXd::Zero(static_cast<Index>(state.get_ndx())), whole = half;
  double off = 0, far = 0;
  for (std::size_t t = 0; t < xs.size(); ++t) {
    state.diff(xs_before[t], xs[t], half);
    state.diff(xs_before[t], xs_after[t], whole);
    off = sparse::larger_or_nan((half - 0.5 * whole).lpNorm<Eigen::Infinity>(), off);
    far = sparse::larger_or_nan(whole.lpNorm<Eigen::Infinity>(), far);
  }
  return off <= kInLine * far;
}

// kInfeasible where the least violation is not zero and shown to be one, by C^T r and from beside it as well; kNone
// where a solve may go on, from a candidate that meets the constraints or is much nearer; kNoStep where nothing is
// shown.
StopReason AL::restore(std::size_t maxiter) {
  if (++restorations_ > kRestorations) return StopReason::kNoStep;
  const double met = 0.5 * th_constraint_ * th_constraint_;
  Restoration own = violationAlone(met);
  const auto take_back = [&](const std::vector<Eigen::VectorXd>& xs, const std::vector<Eigen::VectorXd>& us,
                             bool feasible) {
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
  const auto goes_on = [&] { return violation_ > th_constraint_ && !interrupted_; };
  leastViolation(own);
  if (is_absurd() && feasible_before && goes_on()) {  // by steps of moderate size, then
    take_back(xs_before, us_before, true);
    level(own);
  }
  bool stationary = isStationary(own);
  for (int k = 0; stationary && goes_on(); ++k) {  // a maximum, a saddle, or a least one of several is stationary too
    Beside beside = Beside::kUnclear;
    for (const double by : kBeside)
      if (beside == Beside::kUnclear && goes_on()) beside = lookBeside(own, by);
    bool falls = beside == Beside::kFalls;
    for (const double by : kElsewhere) falls = falls || (goes_on() && lookBeside(own, by) == Beside::kFalls);
    stationary = !falls && beside == Beside::kComesBack;
    if (!falls || k == kSaddles) break;
    leastViolation(own);
    stationary = isStationary(own);
  }
  if (interrupted_) return StopReason::kInterrupted;
  // Of less than this nothing is shown: its square is rounding of the squares that it is made of.
  const double shown = std::sqrt(std::numeric_limits<double>::epsilon()) * largest_number(xs_);
  if (violation_ > std::max(th_constraint_, shown) &&
      stationary) {  // where the candidate was as near, its motion is the better one
    if (feasible_before && violation_before <= kAsNear * violation_) take_back(xs_before, us_before, true);
    return StopReason::kInfeasible;
  }
  // Met by a motion that is none (torques so large that the steps no longer hold the contacts), or no nearer although
  // nothing else was asked for: nothing is shown then.
  const bool absurd = is_absurd();
  const bool nearer = violation_ <= std::max(th_constraint_, kMuchNearer * violation_before);
  if (absurd || violation_ > violation_before) take_back(xs_before, us_before, false);
  if (absurd || !nearer) return StopReason::kNoStep;
  if (is_large()) takeCostOf(violation_before);
  return total_ >= maxiter ? StopReason::kIterations : StopReason::kNone;
}

// The size of the cost, and of the penalty that outweighs it, as of the candidate, which costs more than the guess
// told: violation: what it costs nothing to leave.
void AL::takeCostOf(double violation) {
  constexpr double kOrdinary = 1e4;  // a cost that th_stop and th_kkt suit
  scale_ = std::max(scale_, std::exp2(std::round(std::log2(std::abs(cost_) / kOrdinary))));
  inner_->set_scale(scale_);
  set_penalty(std::max(rho_, 2 * std::abs(cost_) / (violation * violation)));
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
