#include "manycontact/control/augmented_lagrangian.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraint_rows.hpp"
#include "kkt_residual.hpp"
#include "manycontact/control/box_solvers.hpp"

namespace manycontact {

using Vectors = std::vector<Eigen::VectorXd>;
using Index = Eigen::Index;
using internal::ConstraintRows;
using internal::larger;
using internal::rows_at;

namespace {

constexpr const char* kSolverAugmentedLagrangian = "SolverAugmentedLagrangian";
constexpr double kProgress = 0.1;  // of m by one minimisation, or the penalty grows
constexpr double kHoped = 0.3;     // of m by the next one, and what may be missed of that
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr std::size_t kPolishing = 20;  // iterations where reductions drown in the cost's rounding
constexpr int kPatience = 4;            // minimisations in a row that bring nothing
constexpr int kFlat = 2;                // minimisations in a row that bring constraints no closer
constexpr double kCloser = 0.5;         // of the violation before: closer. Ten times the penalty should bring a tenth
constexpr double kOutweighs = 10;       // what constraints add to the cost, of the cost
constexpr double kStationary = 1e-3;    // what a step is to gain, of what constraints add to the cost

std::shared_ptr<SolverDDP> usual_solver(std::shared_ptr<ShootingProblem> problem) {
  const auto& models = problem->get_runningModels();
  const bool limited =
      std::any_of(models.begin(), models.end(), [](const auto& model) { return model->get_has_control_limits(); });
  if (limited) return std::make_shared<SolverBoxFDDP>(std::move(problem));
  return std::make_shared<SolverFDDP>(std::move(problem));
}

// The reduction at which a minimisation may stop after one that left m: what is missed moves constraints by 0.09 m.
double tolerance_after(double m, double rho, double smallest) {
  const double missed = kHoped * std::max(kHoped * std::min(m, 1.0), smallest);
  return 0.5 * rho * missed * missed;
}

// Of a Newton step from a candidate without gaps, at its direction.
double expected_reduction(const SolverDDP& solver) {
  double out = 0;
  for (std::size_t t = 0; t < solver.get_k().size(); ++t) out += 0.5 * solver.get_Qu()[t].dot(solver.get_k()[t]);
  return out;
}

}  // namespace

// Passes each iteration of the unconstrained solver on to the callbacks.
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
    : SolverAbstract(std::move(problem)) {
  decorate();
  inner_ = make(augmented_);
  require(inner_ != nullptr && inner_->get_problem() == augmented_, kSolverAugmentedLagrangian,
          "a solver of the problem that was passed is expected");
  inner_->setCallbacks({std::make_shared<Relay>(*this)});
}

SolverAugmentedLagrangian::~SolverAugmentedLagrangian() = default;

// ---- nodes --------------------------------------------------------------------------------------------------------

// Whether augmented_ is still that of the problem's nodes.
bool SolverAugmentedLagrangian::is_decorated() const {
  const std::size_t T = problem_->get_T();
  if (augmented_->get_T() != T) return false;
  for (std::size_t t = 0; t <= T; ++t) {
    const auto& data = augmented_->data(t);
    if ((rows_at(*problem_, t).size() > 0) != (nodes_[t] != nullptr)) return false;
    if (nodes_[t] == nullptr ? augmented_->model(t) != problem_->model(t) || data != problem_->data(t)
                             : augmented_->model(t) != nodes_[t] || nodes_[t]->get_model() != problem_->model(t) ||
                                   static_cast<ActionDataAugmentedLagrangian&>(*data).inner != problem_->data(t))
      return false;
    if (nodes_[t] && nodes_[t]->get_multipliers().size() != rows_at(*problem_, t).size()) return false;
  }
  return true;
}

SolverAugmentedLagrangian::Node SolverAugmentedLagrangian::decorated(std::size_t t,
                                                                     const Eigen::VectorXd& multipliers) const {
  auto node = std::make_shared<ActionModelAugmentedLagrangian>(problem_->model(t));
  node->set_penalty(rho_);
  node->set_multipliers(multipliers);
  return node;
}

// Nodes without constraints are the problem's own. Multipliers stay where node t has as many constraints as before.
void SolverAugmentedLagrangian::decorate() {
  const std::size_t T = problem_->get_T();
  const Vectors multipliers = get_multipliers();
  nodes_.assign(T + 1, nullptr);
  y_next_.resize(T + 1);
  ShootingProblem::Models models;
  ShootingProblem::Datas datas;
  for (std::size_t t = 0; t <= T; ++t) {
    models.push_back(problem_->model(t));
    datas.push_back(problem_->data(t));
    const Index rows = rows_at(*problem_, t).size();
    y_next_[t].setZero(rows);
    if (rows == 0) continue;
    const bool kept = t < multipliers.size() && multipliers[t].size() == rows;
    nodes_[t] = decorated(t, kept ? multipliers[t] : y_next_[t]);
    datas[t] = nodes_[t]->createData(datas[t]);
    models[t] = nodes_[t];
  }
  const auto terminal = models.back();
  const auto terminal_data = datas.back();
  models.pop_back();
  datas.pop_back();
  if (augmented_ == nullptr) {
    augmented_ = std::make_shared<ShootingProblem>(problem_->get_x0(), models, terminal, datas, terminal_data);
  } else {
    *augmented_ = ShootingProblem(problem_->get_x0(), models, terminal, datas, terminal_data);
  }
  gap_.setZero(static_cast<Index>(problem_->get_ndx()));
}

void SolverAugmentedLagrangian::resizeData() {
  SolverAbstract::resizeData();
  if (!is_decorated()) decorate();
  inner_->resizeData();
}

void SolverAugmentedLagrangian::circularAppend(std::shared_ptr<ActionModelAbstract> model) {
  internal::given(kSolverAugmentedLagrangian, model);
  circularAppend(model, model->createData());
}

void SolverAugmentedLagrangian::circularAppend(std::shared_ptr<ActionModelAbstract> model,
                                               std::shared_ptr<ActionDataAbstract> data) {
  resizeData();
  problem_->circularAppend(std::move(model), std::move(data));
  const std::size_t last = problem_->get_T() - 1;
  std::rotate(nodes_.begin(), nodes_.begin() + 1, nodes_.end() - 1);
  std::rotate(y_next_.begin(), y_next_.begin() + 1, y_next_.end() - 1);
  y_next_[last].setZero(rows_at(*problem_, last).size());
  nodes_[last] = y_next_[last].size() == 0 ? nullptr : decorated(last, y_next_[last]);
  if (nodes_[last])
    augmented_->circularAppend(nodes_[last], nodes_[last]->createData(problem_->data(last)));
  else
    augmented_->circularAppend(problem_->model(last), problem_->data(last));
}

Vectors SolverAugmentedLagrangian::get_multipliers() const {
  Vectors out(nodes_.size());
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    if (nodes_[t]) out[t] = nodes_[t]->get_multipliers();
  return out;
}

void SolverAugmentedLagrangian::set_multipliers(const Vectors& multipliers) {
  resizeData();
  require(multipliers.size() == nodes_.size(), kSolverAugmentedLagrangian, "the number of multipliers is not T + 1");
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    check_size(kSolverAugmentedLagrangian, "multipliers of a node", multipliers[t].size(),
               static_cast<std::size_t>(y_next_[t].size()));
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    if (nodes_[t]) nodes_[t]->set_multipliers(multipliers[t]);
}

void SolverAugmentedLagrangian::reset() {
  resizeData();
  set_penalty(rho_init_);
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    if (nodes_[t]) nodes_[t]->set_multipliers(Eigen::VectorXd::Zero(y_next_[t].size()));
}

// ---- the method of multipliers ------------------------------------------------------------------------------------

bool SolverAugmentedLagrangian::solve(const Vectors& init_xs, const Vectors& init_us, std::size_t maxiter,
                                      bool is_feasible, double init_reg) {
  start(init_xs, init_us, is_feasible);
  for (reason_ = StopReason::kNone; reason_ == StopReason::kNone;) {
    minimise(maxiter, outer_ == 0 ? init_reg : NAN);
    ++outer_;
    assess();
    reason_ = judge(maxiter);
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
  outer_ = total_ = iter_ = 0;
  stuck_ = flat_ = 0;
  cost_ = problem_->calc(xs_, us_);
  merit_ = NAN;
  measureViolation();
  last_measure_ = last_violation_ = best_kkt_ = std::numeric_limits<double>::infinity();
  tolerance_ = std::max(th_stop_, tolerance_after(violation_, rho_, th_constraint_));
}

void SolverAugmentedLagrangian::minimise(std::size_t maxiter, double init_reg) {
  // Steps are accepted unseen where what they are to gain is less than the cost's rounding.
  const double rounding = 100 * kEps * std::abs(outer_ == 0 ? cost_ : inner_->get_cost());
  inner_->set_th_grad(std::isfinite(rounding) ? std::max(1e-12, rounding) : 1e-12);
  inner_->set_th_stop(tolerance_);
  std::size_t most = maxiter - std::min(maxiter, total_);
  if (outer_ > 0 && tolerance_ < rounding) most = std::min(most, kPolishing);
  moved_ = false;
  inner_->solve(xs_, us_, most, is_feasible_, init_reg);
  takeCandidate();
}

void SolverAugmentedLagrangian::takeCandidate() {
  for (std::size_t t = 0; t < xs_.size(); ++t) xs_[t] = inner_->get_xs()[t];
  for (std::size_t t = 0; t < us_.size(); ++t) us_[t] = inner_->get_us()[t];
  is_feasible_ = inner_->get_is_feasible();
}

// After a step the nodes' data are those of the candidate; without one (then the merit has not changed) of the last
// try.
void SolverAugmentedLagrangian::reportIteration() {
  takeCandidate();
  for (std::size_t t = 0; t < fs_.size(); ++t) fs_[t] = inner_->get_fs()[t];
  if (inner_->get_cost() != merit_) {
    moved_ = true;
    merit_ = inner_->get_cost();
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
  iter_ = total_++;
  for (const auto& callback : callbacks_) (*callback)(*this);
  if (interrupted_) inner_->interrupt();
}

// gfeas, hfeas and violation of the nodes as evaluated.
void SolverAugmentedLagrangian::measureViolation() {
  gfeas_ = computeInequalityFeasibility();
  hfeas_ = computeEqualityFeasibility();
  violation_ = internal::infeasibility(*problem_, internal::Rows::kAll, LInf);
}

// Violation, m and KKT residual at the candidate, with y+ and the value function's gradients as multipliers. (Those of
// a plain adjoint recursion would grow with the robots' unstable motions.)
void SolverAugmentedLagrangian::assess() {
  if (inner_->get_iter() > 0) augmented_->calc(xs_, us_);  // else computeDirection does
  inner_->set_preg(inner_->get_reg_min());
  inner_->computeDirection(true);
  merit_ = augmented_->total_cost();
  cost_ = problem_->total_cost();
  while (!inner_->direction_is_sound() && inner_->get_preg() < inner_->get_reg_max()) {
    inner_->increaseRegularization();
    inner_->computeDirection(false);
  }
  measureViolation();
  measure_ = 0;
  for (std::size_t t = 0; t <= problem_->get_T(); ++t) {
    if (!nodes_[t]) continue;
    y_next_[t] = static_cast<ActionDataAugmentedLagrangian&>(*augmented_->data(t)).y_next;
    const Eigen::VectorXd& y = nodes_[t]->get_multipliers();
    for (Index i = 0; i < y.size(); ++i) measure_ = larger(std::abs(y_next_[t][i] - y[i]) / rho_, measure_);
  }
  kkt_ = internal::kkt_residual_of_data(*problem_, xs_, us_, inner_->get_Vx(), inner_->keeps_limits(), y_next_, gap_);
  if (!inner_->direction_is_sound()) kkt_ = std::numeric_limits<double>::infinity();
}

StopReason SolverAugmentedLagrangian::judge(std::size_t maxiter) {
  const StopReason inner = inner_->reason();
  const bool met = violation_ <= th_constraint_;
  if (met && kkt_ <= th_kkt_ && (inner_->get_stop() < th_stop_ || inner == StopReason::kNoStep))
    return StopReason::kConverged;
  if (inner == StopReason::kInterrupted || interrupted_) return StopReason::kInterrupted;
  if (inner == StopReason::kNoDirection) return inner;
  if (!std::isfinite(measure_)) return StopReason::kNoStep;
  if (comesNoCloser(inner)) return StopReason::kInfeasible;
  if (total_ >= maxiter) return flat_ > 0 ? StopReason::kInfeasible : StopReason::kIterations;
  const bool progress = (last_measure_ > th_constraint_ && measure_ <= 0.5 * last_measure_) || kkt_ <= 0.5 * best_kkt_;
  if (met && !moved_ && !progress && inner == StopReason::kNoStep) return inner;
  const bool grows = measure_ > th_constraint_ && rho_ < rho_max_;
  stuck_ = progress || grows || (met && inner == StopReason::kIterations) ? 0 : stuck_ + 1;
  if (stuck_ < kPatience) return StopReason::kNone;
  return met ? StopReason::kNoStep : StopReason::kInfeasible;
}

// Where the augmented Lagrangian is nearly the constraints' alone, at its minima, or where a step is to gain next to
// nothing of what they add: the violation is stationary.
bool SolverAugmentedLagrangian::comesNoCloser(StopReason inner) {
  const double added = merit_ - cost_;
  const bool settled =
      inner != StopReason::kIterations || (is_feasible_ && expected_reduction(*inner_) < kStationary * added);
  const bool closer = violation_ <= th_constraint_ || violation_ <= kCloser * last_violation_;
  flat_ = settled && !closer && added > kOutweighs * std::abs(cost_) ? flat_ + 1 : 0;
  return flat_ >= kFlat;
}

void SolverAugmentedLagrangian::updateMultipliers() {
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    if (nodes_[t]) nodes_[t]->set_multipliers(y_next_[t]);
  if (reason_ == StopReason::kConverged) return;
  const bool small = measure_ <= th_constraint_;
  if (!small && !(measure_ <= kProgress * last_measure_)) set_penalty(std::min(rho_ * rho_factor_, rho_max_));
  tolerance_ = std::min(small ? std::min(0.01 * tolerance_, th_stop_) : tolerance_,
                        tolerance_after(measure_, rho_, th_constraint_));
  tolerance_ = std::max(tolerance_, 1e-30);
  last_measure_ = measure_;
  last_violation_ = violation_;
  best_kkt_ = std::min(best_kkt_, kkt_);
}

// ---- settings -----------------------------------------------------------------------------------------------------

void SolverAugmentedLagrangian::set_penalty(double penalty) {
  require(penalty > 0 && std::isfinite(penalty), kSolverAugmentedLagrangian, "a positive penalty is expected");
  rho_ = penalty;
  for (const Node& node : nodes_)
    if (node) node->set_penalty(rho_);
}
void SolverAugmentedLagrangian::set_penalty_init(double penalty) {
  set_penalty(penalty);
  rho_init_ = penalty;
}
void SolverAugmentedLagrangian::set_penalty_factor(double factor) {
  require(factor > 1 && std::isfinite(factor), kSolverAugmentedLagrangian, "a factor above 1 is expected");
  rho_factor_ = factor;
}
void SolverAugmentedLagrangian::set_penalty_max(double penalty) {
  require(penalty > 0 && std::isfinite(penalty), kSolverAugmentedLagrangian, "a positive penalty is expected");
  rho_max_ = penalty;
}
void SolverAugmentedLagrangian::set_th_constraint(double th_constraint) {
  require(th_constraint > 0, kSolverAugmentedLagrangian, "a positive tolerance is expected");
  th_constraint_ = th_constraint;
}
void SolverAugmentedLagrangian::set_th_kkt(double th_kkt) {
  require(th_kkt > 0, kSolverAugmentedLagrangian, "a positive tolerance is expected");
  th_kkt_ = th_kkt;
}

}  // namespace manycontact
