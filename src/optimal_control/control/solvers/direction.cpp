#include "manycontact/control/direction.hpp"

#include <algorithm>
#include <limits>

#include "manycontact/control/fit.hpp"
#include "manycontact/control/solver.hpp"

namespace manycontact {

using Eigen::VectorXd;
using Vectors = Direction::Vectors;

namespace {

// Sets out = 0, 1, ..., count - 1.
void count_up(std::size_t count, std::vector<int>& out) {
  if (out.size() != count) out = internal::range(0, static_cast<int>(count));
}

}  // namespace

void Direction::resize() {
  const ShootingProblem& problem = *part_.problem;
  const std::size_t T = problem.get_T();
  if (is_whole_) {
    count_up(problem.get_nx(), part_.x);
    count_up(problem.get_ndx(), part_.dx);
    part_.u.resize(T);
    for (std::size_t t = 0; t < T; ++t) count_up(problem.model(t)->get_nu(), part_.u[t]);
  }
  internal::fit_all(T + 1, problem.get_nx(), xs_, xs_try_);
  internal::fit_all(T + 1, problem.get_ndx(), fs_, Vx_);
  internal::fit_all(T, problem.get_ndx(), dx_);
  internal::fit_controls(problem, us_, us_try_, k_, feed_forward_);
  internal::fit(step_, problem.get_ndx());
  internal::fit(xnext_, problem.get_nx());
}

std::vector<int> Direction::blocks() const {
  std::size_t nu = 0;
  for (const auto& model : part_.problem->get_runningModels()) nu = std::max(nu, model->get_nu());
  return {static_cast<int>(nu)};
}

void Direction::take(const VectorXd& whole, const std::vector<int>& index, VectorXd& own) const {
  is_whole_ ? void(own = whole) : gather(whole, index, own);
}
void Direction::give(const VectorXd& own, const std::vector<int>& index, VectorXd& whole) const {
  is_whole_ ? void(whole = own) : scatter(own, index, whole);
}
void Direction::take_u(const Vectors& whole, Vectors& own) const {
  for (std::size_t t = 0; t < own.size(); ++t) take(whole[t], part_.u[t], own[t]);
}
void Direction::give_u(const Vectors& own, Vectors& whole) const {
  for (std::size_t t = 0; t < own.size(); ++t) give(own[t], part_.u[t], whole[t]);
}

void Direction::take_candidate(const ShootingProblem& problem, const Vectors& xs, const Vectors& us, const Vectors& fs,
                               bool is_feasible) {
  if (part_.problem.get() != &problem) {
    take_x(problem.get_x0(), xnext_);
    part_.problem->set_x0(xnext_);
  }
  for (std::size_t t = 0; t < xs_.size(); ++t) {
    take_x(xs[t], xs_[t]);
    take_dx(fs[t], fs_[t]);
  }
  take_u(us, us_);
  is_feasible_ = is_feasible;
}

double Direction::roll_out(double steplength, bool keep_gaps, bool keep_terminal_gap) {
  ShootingProblem& problem = *part_.problem;
  const std::size_t T = problem.get_T();
  double cost = 0;
  xnext_ = problem.get_x0();
  for (std::size_t t = 0; t <= T; ++t) {
    if (t < T ? keep_gaps : keep_terminal_gap) {
      step_ = (steplength - 1) * fs_[t];
      problem.model(t)->get_state()->integrate(xnext_, step_, xs_try_[t]);
    } else {
      xs_try_[t] = xnext_;
    }
    if (!problem.by_state_alone(t)) step_control(t, steplength);
    problem.calc_node(t, xs_try_, us_try_);
    cost += problem.data(t)->cost;
    if (t < T) xnext_ = problem.data(t)->xnext;
    if (raiseIfNaN(cost) || !internal::is_sound(xnext_)) return std::numeric_limits<double>::quiet_NaN();
  }
  return cost;
}

void Direction::set_feed_forward(const Vectors& nu) {
  for (std::size_t t = 0; t < k_.size(); ++t) k_[t] = -nu[t];
}

}  // namespace manycontact
