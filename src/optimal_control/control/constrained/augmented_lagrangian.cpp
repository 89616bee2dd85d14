#include "manycontact/control/augmented_lagrangian.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "../multi_robot/coordinates.hpp"
#include "../solvers/cost_scale.hpp"
#include "constraint_rows.hpp"
#include "kkt_residual.hpp"
#include "manycontact/control/box_solvers.hpp"
#include "manycontact/detail/control/sparse.hpp"
#include "manycontact/sparse/largest.hpp"

namespace manycontact {

using Vectors = std::vector<Eigen::VectorXd>;
using Index = Eigen::Index;

namespace {

constexpr const char* kSolverAugmentedLagrangian = "SolverAugmentedLagrangian";
constexpr double kLargest = std::numeric_limits<double>::max();
constexpr internal::Range kPenalty{0, false, kLargest, "a positive penalty is expected"};
constexpr internal::Range kFactor{1, false, kLargest, "a factor above 1 is expected"};
// Thresholds. m is the largest change of a multiplier in a minimisation, divided by the penalty. `stop` is the expected
// reduction by a step. Penalty terms are the constraints' terms in the augmented Lagrangian.
constexpr double kProgress = 0.1;  // the penalty increases if m is above this multiple of the previous m
constexpr double kHoped = 0.3;     // expected ratio of m after the next minimisation to the current m
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr std::size_t kPolishing = 20;  // most iterations of a minimisation with a tolerance below rounding errors
constexpr int kPatience = 4;            // consecutive minimisations without progress that end the solve
constexpr int kFlat = 2;                // consecutive minimisations without a smaller violation that start restore()
constexpr double kCloser = 0.5;         // the violation decreased if it is at most this multiple of its previous value
constexpr double kOutweighs = 10;       // penalty terms outweigh the cost if they exceed this multiple of the cost
constexpr double kStationary = 1e-3;    // stationary: the expected reduction is below this share of the penalty terms
constexpr int kWindow = 10;             // number of iterations between two tests for slow convergence of a minimisation
constexpr double kSlow = 0.1;       // Gauss-Newton is slow if `stop` exceeds this multiple of `stop` two iterations ago
constexpr double kStillSlow = 0.3;  // and if `stop` exceeds this multiple of `stop` one iteration ago (see kSlow)
constexpr double kNearer = 0.1;     // quasi-Newton steps are retried when `stop` is below this share of that at failure
constexpr double kCrawl = 0.01;     // smallest useful reduction in kWindow iterations, as a share of the penalty terms

std::shared_ptr<SolverDDP> usual_solver(std::shared_ptr<ShootingProblem> problem) {
  const auto& models = problem->get_runningModels();
  const bool limited =
      std::any_of(models.begin(), models.end(), [](const auto& model) { return model->get_has_control_limits(); });
  const bool in_parts = problem->get_ndx() > 0 && problem->get_terminalData()->Fx.size() == 0;
  if (in_parts) return std::make_shared<SolverSparse>(std::move(problem), limited);
  if (limited) return std::make_shared<SolverBoxFDDP>(std::move(problem));
  return std::make_shared<SolverFDDP>(std::move(problem));
}

// Returns the expected reduction at which the next minimisation ends. The constraints' errors are then about 0.09 m,
// where m <= 1 is their current error as defined in assess(), but not less than 0.3 `smallest`.
double tolerance_after(double m, double rho, double smallest) {
  const double missed = kHoped * std::max(kHoped * std::min(m, 1.0), smallest);
  return 0.5 * rho * missed * missed;
}

}  // namespace

// Reports each iteration of the unconstrained solver to the callbacks of this solver.
class SolverAugmentedLagrangian::Relay : public CallbackAbstract {
 public:
  explicit Relay(SolverAugmentedLagrangian& outer) : outer_(outer) {}
  void operator()(SolverAbstract&) override { outer_.reportIteration(); }

 private:
  SolverAugmentedLagrangian& outer_;
};

SolverAugmentedLagrangian::SolverAugmentedLagrangian(std::shared_ptr<ShootingProblem> problem)
    : SolverAugmentedLagrangian(std::move(problem), usual_solver) {}

SolverAugmentedLagrangian::SolverAugmentedLagrangian(std::shared_ptr<ShootingProblem> problem, const MakeSolver& make)
    : SolverAbstract(std::move(problem)), make_(make) {
  decorate();
  inner_ = make(augmented_);
  require(inner_ != nullptr && inner_->get_problem() == augmented_, kSolverAugmentedLagrangian,
          "the solver that was made is null or solves another problem, a solver of the passed problem is expected");
  inner_->set_judges(false);
  inner_->setCallbacks({std::make_shared<Relay>(*this)});
}

SolverAugmentedLagrangian::~SolverAugmentedLagrangian() = default;

bool SolverAugmentedLagrangian::solve(const Vectors& init_xs, const Vectors& init_us, std::size_t maxiter,
                                      bool is_feasible, double init_reg) {
  start(init_xs, init_us, is_feasible);
  for (reason_ = StopReason::kNone; reason_ == StopReason::kNone;) {
    minimise(maxiter, outer_ == 0 ? init_reg : NAN);
    ++outer_;
    assess();
    reason_ = judge(maxiter);
    if (const StopReason judged = reason_;
        judged == StopReason::kInfeasible || (judged == StopReason::kNoDirection && violation_ > th_constraint_)) {
      reason_ = restore(maxiter);
      if (reason_ == StopReason::kNoStep && judged == StopReason::kNoDirection) reason_ = judged;
      if (reason_ == StopReason::kNone) startAgain();
      continue;
    }
    if (reason_ == StopReason::kNone || reason_ == StopReason::kConverged) updateMultipliers();
  }
  return reason_ == StopReason::kConverged;
}

void SolverAugmentedLagrangian::start(const Vectors& init_xs, const Vectors& init_us, bool is_feasible) {
  (void)problem_->is_updated();
  resizeData();
  augmented_->set_x0(problem_->get_x0());
  augmented_->set_nthreads(static_cast<int>(problem_->get_nthreads()));
  setCandidate(init_xs, init_us, is_feasible);
  interrupted_ = false;
  outer_ = reported_ = iter_ = 0;
  stuck_ = flat_ = 0;
  restorations_ = 0;
  curved_ = false;
  failed_stop_ = std::numeric_limits<double>::infinity();
  cost_ = problem_->calc(xs_, us_);
  merit_ = NAN;
  measureViolation();
  if (measures_scale_) {
    problem_->calcDiff(xs_, us_);
    const internal::CostScale measured = internal::cost_scale(*problem_);
    const double before = std::exchange(scale_, measured.cost);
    kkt_scale_ = measured.gradient;
    set_penalty(rho_ * scale_ / before);
  }
  inner_->set_scale(scale_);
  last_measure_ = last_violation_ = best_kkt_ = std::numeric_limits<double>::infinity();
  tolerance_ = std::max(th_stop_ * scale_, tolerance_after(violation_, rho_, th_constraint_));
}

void SolverAugmentedLagrangian::minimise(std::size_t maxiter, double init_reg) {
  // Steps with an expected reduction below the cost's rounding error are accepted without a test (th_grad).
  const double rounding = 100 * kEps * std::abs(outer_ == 0 ? cost_ : inner_->get_cost());
  inner_->set_th_grad(std::isfinite(rounding) ? std::max(1e-12, rounding / scale_) : 1e-12);
  inner_->set_th_stop(tolerance_ / scale_);
  std::size_t most = maxiter - std::min(maxiter, reported_);
  if (outer_ > 0 && tolerance_ < rounding) most = std::min(most, kPolishing);
  moved_ = crawls_ = false;
  window_ = 0;
  window_merit_ = NAN;
  descend(reported_ + most, init_reg);
}

// Minimises by Gauss-Newton steps. If these are slow, continues with quasi-Newton steps (SolverDDP::descend).
void SolverAugmentedLagrangian::descend(std::size_t last, double init_reg) {
  for (;; init_reg = NAN) {
    if (curved_) {
      ended_ = inner_->descend(last - reported_);
      takeCandidate();
      if (ended_ != StopReason::kNoStep || reported_ == last) return;
      curved_ = false;
      failed_stop_ = stop_;
    }
    last_stops_.fill(std::numeric_limits<double>::infinity());
    inner_->solve(xs_, us_, last - reported_, is_feasible_, init_reg);
    takeCandidate();
    ended_ = inner_->reason();
    if (!slow_ || interrupted_ || crawls_) return;
    ended_ = StopReason::kIterations;
    if (reported_ == last) return;
    curved_ = true;
  }
}

void SolverAugmentedLagrangian::takeCandidate() {
  for (std::size_t t = 0; t < xs_.size(); ++t) xs_[t] = inner_->get_xs()[t];
  for (std::size_t t = 0; t < us_.size(); ++t) us_[t] = inner_->get_us()[t];
  is_feasible_ = inner_->get_is_feasible();
}

// Reports an iteration. Measures the violation only after accepted steps: a rejected step leaves its data in nodes.
void SolverAugmentedLagrangian::reportIteration() {
  takeCandidate();
  for (std::size_t t = 0; t < fs_.size(); ++t) fs_[t] = inner_->get_fs()[t];
  merit_ = inner_->get_cost();
  if (inner_->has_stepped()) {
    moved_ = true;
    collectParts();
    cost_ = problem_->total_cost();
    measureViolation();
  }
  stop_ = inner_->get_stop();
  d_ = inner_->get_d();
  dV_ = dPhi_ = inner_->get_dV();
  dVexp_ = dPhiexp_ = inner_->get_dVexp();
  preg_ = inner_->get_preg();
  dreg_ = inner_->get_dreg();
  steplength_ = inner_->get_steplength();
  ffeas_ = inner_->get_ffeas();
  iter_ = reported_;
  callCallbacks();
  if (interrupted_ || crawls() || isSlow()) inner_->interrupt();
}

// Returns whether Gauss-Newton steps converge slowly, and `stop` is small enough to try quasi-Newton steps (again).
bool SolverAugmentedLagrangian::isSlow() {
  slow_ = !curved_ && is_feasible_ && stop_ > tolerance_ && stop_ > kSlow * last_stops_[0] &&
          stop_ > kStillSlow * last_stops_[1] && stop_ < kNearer * failed_stop_;
  last_stops_ = {last_stops_[1], stop_};
  return slow_;
}

// Tests every kWindow iterations whether these hardly reduced the augmented Lagrangian and the violation.
bool SolverAugmentedLagrangian::crawls() {
  if (window_++ % kWindow != 0) return false;
  crawls_ = is_feasible_ && violation_ > th_constraint_ && violation_ > kCloser * window_violation_ &&
            window_merit_ - merit_ < kCrawl * (merit_ - cost_);
  window_merit_ = merit_;
  window_violation_ = violation_;
  return crawls_;
}

void SolverAugmentedLagrangian::measureViolation() {
  gfeas_ = computeInequalityFeasibility();
  hfeas_ = computeEqualityFeasibility();
  violation_ = internal::infeasibility(*problem_, internal::Rows::kAll, LInf);
}

// Computes violation, KKT residual and m = max |y+ - y| / rho at the candidate, where rho is the penalty, y are the
// constraints' multipliers, and y+ the next ones. The KKT residual has the multipliers y+, and Vx for the dynamics,
// because multipliers from an adjoint recursion would grow for unstable motions.
void SolverAugmentedLagrangian::assess() {
  if (inner_->get_iter() > 0) augmented_->calc(xs_, us_);  // computeDirection calls calc itself at iteration 0
  inner_->set_preg(inner_->get_reg_min() * scale_);
  inner_->computeDirection(true);
  collectParts();
  merit_ = augmented_->total_cost();
  cost_ = problem_->total_cost();
  while (!inner_->direction_is_sound() && inner_->get_preg() < inner_->get_reg_max() * scale_) {
    inner_->increaseRegularization();
    inner_->computeDirection(false);
  }
  measureViolation();
  measure_ = kkt_ = 0;
  for (std::size_t t = 0; t <= problem_->get_T(); ++t) {
    for (const Augmented& own : nodes_[t].augmented) {
      const Eigen::VectorXd &y = own.model->get_multipliers(), &next = own.data->y_next;
      const internal::ConstraintRows rows(*own.model->get_model(), problem_->by_state_alone(t));
      for (Index i = 0; i < y.size(); ++i) {
        measure_ = sparse::larger_or_nan(std::abs(next[i] - y[i]) / rho_, measure_);
        const double c = rows.value(*own.data->inner, i);
        kkt_ = sparse::larger_or_nan(
            std::abs(c - std::min(std::max(c + next[i] / kkt_scale_, rows.lower(i)), rows.upper(i))), kkt_);
      }
    }
  }
  kkt_ = sparse::larger_or_nan(internal::kkt_residual_of_nodes(*augmented_, xs_, us_, inner_->get_Vx(),
                                                               inner_->keeps_limits(), {}, kkt_scale_, work_),
                               kkt_);
  if (std::isnan(kkt_) || !inner_->direction_is_sound()) kkt_ = std::numeric_limits<double>::infinity();
}

StopReason SolverAugmentedLagrangian::judge(std::size_t maxiter) {
  const StopReason inner = ended_;
  const bool met = violation_ <= th_constraint_;
  if (met && kkt_ <= th_kkt_ && (inner_->get_stop() < th_stop_ * scale_ || inner == StopReason::kNoStep))
    return StopReason::kConverged;
  if (interrupted_ || (inner == StopReason::kInterrupted && !crawls_)) return StopReason::kInterrupted;
  if (inner == StopReason::kNoDirection) return inner;
  if (!std::isfinite(measure_)) return StopReason::kNoStep;
  if (comesNoCloser(inner)) return StopReason::kInfeasible;
  if (reported_ >= maxiter) return flat_ > 0 ? StopReason::kInfeasible : StopReason::kIterations;
  const bool progress = (last_measure_ > th_constraint_ && measure_ <= 0.5 * last_measure_) || kkt_ <= 0.5 * best_kkt_;
  if (met && !moved_ && !progress && inner == StopReason::kNoStep) return inner;
  const bool grows = measure_ > th_constraint_ && rho_ < rho_max_ * std::max(scale_, kkt_scale_);
  stuck_ = progress || grows || (met && inner == StopReason::kIterations) ? 0 : stuck_ + 1;
  if (stuck_ < kPatience) return StopReason::kNone;
  return met ? StopReason::kNoStep : StopReason::kInfeasible;
}

// Returns whether kFlat consecutive minimisations with dominating constraints ended without a smaller violation.
bool SolverAugmentedLagrangian::comesNoCloser(StopReason inner) {
  const double added = merit_ - cost_;
  const bool settled =
      inner != StopReason::kIterations || (is_feasible_ && inner_->expectedReduction() < kStationary * added);
  const bool closer = violation_ <= th_constraint_ || violation_ <= kCloser * last_violation_;
  flat_ = settled && !closer && added > kOutweighs * std::abs(cost_) ? flat_ + 1 : 0;
  return flat_ >= kFlat;
}

void SolverAugmentedLagrangian::updateMultipliers() {
  for (const Node& node : nodes_)
    for (const Augmented& own : node.augmented) own.model->set_multipliers(own.data->y_next);
  if (reason_ == StopReason::kConverged) return;
  failed_stop_ = std::numeric_limits<double>::infinity();
  const bool small = measure_ <= th_constraint_;
  if (!small && !(measure_ <= kProgress * last_measure_)) {
    set_penalty(std::min(rho_ * rho_factor_, rho_max_ * std::max(scale_, kkt_scale_)));
    curved_ = false;
  } else if (const double least = rho_init_ * std::min(scale_, kkt_scale_);
             small && kkt_ > th_kkt_ && kkt_ > 0.5 * best_kkt_ && rho_ > least) {
    // Multipliers have errors of rho times the rounding errors of the constraints, which a smaller penalty rho reduces.
    set_penalty(std::max(rho_ / rho_factor_, least));
  }
  tolerance_ = std::min(small ? std::min(0.01 * tolerance_, th_stop_ * scale_) : tolerance_,
                        tolerance_after(measure_, rho_, th_constraint_));
  tolerance_ = std::max(tolerance_, 1e-30 * scale_);
  last_measure_ = measure_;
  last_violation_ = violation_;
  best_kkt_ = std::min(best_kkt_, kkt_);
}

void SolverAugmentedLagrangian::set_penalty(double penalty) {
  kPenalty.set(rho_, penalty, kSolverAugmentedLagrangian);
  for (const Node& node : nodes_)
    for (const Augmented& own : node.augmented) own.model->set_penalty(rho_);
}
void SolverAugmentedLagrangian::set_penalty_init(double penalty) {
  set_penalty(penalty);
  rho_init_ = penalty;
}
void SolverAugmentedLagrangian::set_penalty_factor(double factor) {
  kFactor.set(rho_factor_, factor, kSolverAugmentedLagrangian);
}
void SolverAugmentedLagrangian::set_penalty_max(double penalty) {
  kPenalty.set(rho_max_, penalty, kSolverAugmentedLagrangian);
}
}  // namespace manycontact
