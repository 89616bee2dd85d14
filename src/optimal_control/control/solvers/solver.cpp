#include "manycontact/control/solver.hpp"

#include <iterator>

#include "../constrained/constraint_rows.hpp"
#include "../nodes/nodes.hpp"
#include "manycontact/control/fit.hpp"
#include "manycontact/sparse/largest.hpp"

namespace manycontact {

const char* to_string(StopReason reason) {
  constexpr const char* names[] = {
      "not run", "converged", "iterations", "no direction", "no step", "interrupted", "infeasible constraints"};
  const auto k = static_cast<std::size_t>(reason);
  return k < std::size(names) ? names[k] : "?";
}

namespace {

// Returns the larger of a and b for LInf, the sum a + b for L1, and NaN if a or b is NaN.
double joined(double a, double b, FeasibilityNorm which) { return which == LInf ? sparse::larger_or_nan(a, b) : a + b; }

}  // namespace

double internal::infeasibility(const ShootingProblem& problem, Rows which, FeasibilityNorm norm) {
  double out = 0;
  for (std::size_t t = 0; t <= problem.get_T(); ++t) {
    const ConstraintRows rows = rows_at(problem, t);
    const Eigen::Index first = which == Rows::kEqualities ? rows.inequalities() : 0;
    const Eigen::Index last = which == Rows::kInequalities ? rows.inequalities() : rows.size();
    for (Eigen::Index i = first; i < last; ++i) out = joined(out, std::abs(rows.violation(*problem.data(t), i)), norm);
  }
  return out;
}

bool raiseIfNaN(double value) { return !(value < 1e30 && value > -std::numeric_limits<double>::infinity()); }

SolverAbstract::SolverAbstract(std::shared_ptr<ShootingProblem> problem) : problem_(std::move(problem)) {
  internal::given("Solver", problem_, "a shooting problem");
  SolverAbstract::resizeData();
}

void SolverAbstract::resizeData() {
  const std::size_t T = problem_->get_T();
  const std::size_t nodes = xs_.size();
  xs_.resize(T + 1);
  fs_.resize(T + 1);
  for (std::size_t t = nodes; t <= T; ++t) xs_[t] = problem_->model(t)->get_state()->zero();
  internal::fit_controls(*problem_, us_);
  for (Eigen::VectorXd& f : fs_)
    if (f.size() == 0) f.setZero(problem_->get_ndx());
}

double SolverAbstract::computeDynamicFeasibility() {
  const ShootingProblem::Models& models = problem_->get_runningModels();
  const ShootingProblem::Datas& datas = problem_->get_runningDatas();
  models[0]->get_state()->diff(xs_[0], problem_->get_x0(), fs_[0]);
  internal::each_node(problem_->get_nthreads(), models.size(), gaps_time_,
                      [&](std::size_t t) { models[t]->get_state()->diff(xs_[t + 1], datas[t]->xnext, fs_[t + 1]); });
  double feasibility = 0;
  for (const Eigen::VectorXd& f : fs_)
    for (const double gap : f) feasibility = joined(feasibility, std::abs(gap), feasnorm_);
  return feasibility;
}

double SolverAbstract::computeInequalityFeasibility() {
  return internal::infeasibility(*problem_, internal::Rows::kInequalities, feasnorm_);
}

double SolverAbstract::computeEqualityFeasibility() {
  return internal::infeasibility(*problem_, internal::Rows::kEqualities, feasnorm_);
}

void SolverAbstract::check_xs(const char* where, const Vectors& xs) const {
  require(xs.size() == problem_->get_T() + 1, where, "the number of states is not T + 1");
  for (const Eigen::VectorXd& x : xs) check_size(where, "a state", x.size(), problem_->get_nx());
}

void SolverAbstract::check_us(const char* where, const Vectors& us) const {
  require(us.size() == problem_->get_T(), where, "the number of controls is not T");
  for (std::size_t t = 0; t < us.size(); ++t)
    check_size(where, "a control", us[t].size(), problem_->get_runningModels()[t]->get_nu());
}

void SolverAbstract::setCandidate(const Vectors& xs_warm, const Vectors& us_warm, bool is_feasible) {
  if (!xs_warm.empty()) check_xs("Solver::setCandidate", xs_warm);
  if (!us_warm.empty()) check_us("Solver::setCandidate", us_warm);
  if (!xs_warm.empty()) xs_ = xs_warm;
  if (!us_warm.empty()) us_ = us_warm;
  for (std::size_t t = 0; t < xs_.size() && xs_warm.empty(); ++t) xs_[t] = problem_->model(t)->get_state()->zero();
  for (std::size_t t = 0; t < us_.size() && us_warm.empty(); ++t) us_[t].setZero();
  is_feasible_ = is_feasible;
}

void SolverAbstract::setCallbacks(const Callbacks& callbacks) {
  for (const auto& callback : callbacks)
    require(callback != nullptr, "Solver::setCallbacks", "a callback is a null pointer");
  callbacks_ = std::make_shared<const Callbacks>(callbacks);
}

void SolverAbstract::callCallbacks() {
  ++reported_;
  const auto callbacks = callbacks_;
  for (const auto& callback : *callbacks) (*callback)(*this);
}

void SolverAbstract::set_xs(const Vectors& xs) {
  check_xs("Solver::set_xs", xs);
  xs_ = xs;
}
void SolverAbstract::set_us(const Vectors& us) {
  check_us("Solver::set_us", us);
  us_ = us;
}
}  // namespace manycontact
