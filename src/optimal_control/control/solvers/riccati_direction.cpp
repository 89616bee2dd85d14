#include "manycontact/control/riccati_direction.hpp"

#include <cmath>

#include "../../lq/dense.hpp"
#include "../integrators/euler_steps.hpp"
#include "manycontact/control/fit.hpp"

namespace manycontact {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Vectors = Direction::Vectors;

namespace {

const IntegratedActionDataEuler* without_matrices(const ActionDataAbstract& data) {
  return data.has_matrices() ? nullptr : dynamic_cast<const IntegratedActionDataEuler*>(&data);
}

// Returns whether the backward pass can read a node's derivatives: matrices with ndx rows, or a panel of Euler's data.
bool is_readable(const ActionDataAbstract& data, Index ndx) {
  return data.has_matrices() ? data.Fx.rows() == ndx : without_matrices(data) != nullptr;
}

using Block = lq::RiccatiStep::Matrix;
using Sparse = Eigen::SparseMatrix<double>;

// Adds weight A to `to`. symmetric: adds only the lower triangle of A.
void add(const Sparse& A, bool symmetric, double weight, Block to) {
  for (Index j = 0; j < A.outerSize(); ++j)
    for (Sparse::InnerIterator it(A, j); it; ++it)
      if (!symmetric || it.row() >= j) to(it.row(), j) += weight * it.value();
}
void add_lower(const MatrixXd& A, Block to) {
  for (Index j = 0; j < A.cols(); ++j) to.col(j).tail(A.rows() - j) += A.col(j).tail(A.rows() - j);
}

// Returns whether v and the lower triangle of V are finite and below 1e30.
bool is_sound(const MatrixXd& V, const VectorXd& v) {
  for (Index j = 0; j < V.cols(); ++j)
    if (!(std::abs(v[j]) + V.col(j).tail(V.rows() - j).lpNorm<1>() < 1e30)) return false;
  return true;
}

}  // namespace

// Resizes vectors and matrices to the subproblem. Allocates only those whose sizes have changed.
void RiccatiDirection::resize() {
  Direction::resize();
  node_ = kNoNode;
  const ShootingProblem& problem = *part_.problem;
  const std::size_t T = problem.get_T();
  const Index ndx = static_cast<Index>(problem.get_ndx());
  for (std::size_t t = 0; t <= T; ++t)
    require(is_readable(*problem.data(t), ndx), "SolverDDP",
            "a node's data have no matrices (ActionModelParts with storage kSparse), SolverSparse is expected");
  internal::fit_all(T + 1, problem.get_ndx(), Vxx_fs_);
  internal::fit_all(T, problem.get_ndx(), Qx_);
  internal::fit_controls(problem, Qu_, Quuk_);
  for (auto* matrices : {&Qxx_, &Qxu_, &Quu_, &L_}) matrices->resize(T);
  Vxx_.resize(T + 1);
  K_.resize(T);
  for (MatrixXd& V : two_values_) internal::fit(V, keeps_values_ ? 0 : ndx, keeps_values_ ? 0 : ndx);
  for (std::size_t t = 0; t <= T; ++t) {
    if (keeps_values_) internal::fit(Vxx_[t], ndx, ndx);
    if (t == T) break;
    const Index nu = static_cast<Index>(problem.model(t)->get_nu());
    if (keeps_values_) {
      internal::fit(Qxx_[t], ndx, ndx);
      internal::fit(Qxu_[t], ndx, nu);
      internal::fit(Quu_[t], nu, nu);
    }
    internal::fit(K_[t], nu, ndx);
    if (L_[t].rows() != nu) L_[t].setIdentity(nu, nu);
    riccati_.lay_out(static_cast<int>(nu), static_cast<int>(ndx));
  }
}

bool RiccatiDirection::compute(double preg, double) {
  const ShootingProblem& problem = *part_.problem;
  const std::size_t T = problem.get_T();
  const ActionDataAbstract& terminal = *problem.get_terminalData();
  preg_ = preg;
  MatrixXd& V = value(T);
  if (const auto* euler = without_matrices(terminal)) {
    V.setZero();
    add(euler->differential->Lxx_sparse(), false, 1,
        Block(V.data(), V.rows(), V.cols(), Eigen::OuterStride<>(V.rows())));
  } else {
    V = terminal.Lxx;
  }
  Vx_[T] = terminal.Lx;
  V.diagonal().array() += preg_;
  add_gap(T);
  for (std::size_t t = T; t-- > 0;) {
    compute_action_value_function(t, *problem.model(t), *problem.data(t));
    if (!compute_gains(t)) return false;
    compute_value_function(t);
    if (!is_sound(value(t), Vx_[t])) return false;
  }
  return true;
}

void RiccatiDirection::add_gap(std::size_t t) {
  if (is_feasible_) return;
  Vxx_fs_[t].noalias() = value(t) * fs_[t];
  Vx_[t] += Vxx_fs_[t];
}

// Copies [Fu Fx] of a node into riccati_ and returns null. For symplectic Euler, copies only the lower half and returns
// the structure that gives the upper half.
const lq::SymplecticStructure* RiccatiDirection::set_dynamics(const ActionModelAbstract& model,
                                                              const ActionDataAbstract& data) {
  const auto* euler = dynamic_cast<const IntegratedActionDataEuler*>(&data);
  if (!euler || !internal::known_steps(model, data)) {
    riccati_.set_A(data.Fx);
    riccati_.set_B(data.Fu);
    return nullptr;
  }
  internal::fill_steps(*euler, steps_);
  const Index ndx = static_cast<Index>(part_.problem->get_ndx()), n = ndx / 2;
  if (data.has_matrices()) {
    riccati_.set_A(data.Fx.bottomRows(n));
    riccati_.set_B(data.Fu.bottomRows(n));
    return &steps_;
  }
  const PanelView& a = euler->panel();
  for (Index i = 0; i < n; ++i) {
    double *row = riccati_.row(static_cast<int>(i)), *x = row + riccati_.x_start();
    const double *ax = a.data() + i * a.outerStride(), *au = ax + ndx;
    for (Index j = 0; j < ndx; ++j) x[j] = euler->step * ax[j];
    for (Index j = 0; j < a.cols() - ndx; ++j) row[j] = euler->step * au[j];
    x[n + i] += 1;
  }
  return &steps_;
}

void RiccatiDirection::add_hessians(const ActionDataAbstract& data) {
  if (const auto* euler = without_matrices(data)) {
    const DifferentialActionDataAbstract& cost = *euler->differential;
    add(cost.Luu_sparse(), true, euler->step, riccati_.Qvv());
    add(cost.Lxu_sparse(), false, euler->step, riccati_.Qxv());
    add(cost.Lxx_sparse(), true, euler->step, riccati_.Qxx());
  } else {
    add_lower(data.Luu, riccati_.Qvv());
    riccati_.Qxv() += data.Lxu;
    add_lower(data.Lxx, riccati_.Qxx());
  }
}

void RiccatiDirection::compute_action_value_function(std::size_t t, const ActionModelAbstract& model,
                                                     const ActionDataAbstract& data) {
  node_ = kNoNode;
  riccati_.lay_out(static_cast<int>(model.get_nu()), static_cast<int>(part_.problem->get_ndx()));
  const lq::SymplecticStructure* steps = set_dynamics(model, data);
  if (steps)
    riccati_.multiply(value(t + 1), *steps);
  else
    riccati_.multiply(value(t + 1));
  riccati_.multiply_vector(Vx_[t + 1], steps, Qu_[t], Qx_[t]);
  add_hessians(data);
  riccati_.Qvv().diagonal().array() += preg_;
  Qx_[t] += data.Lx;
  Qu_[t] += data.Lu;
  node_ = t;
  if (!keeps_values_) return;
  Qxx_[t].triangularView<Eigen::Lower>() = riccati_.Qxx();
  Quu_[t].triangularView<Eigen::Lower>() = riccati_.Qvv();
  Qxu_[t] = riccati_.Qxv();
  for (MatrixXd* Q : {&Qxx_[t], &Quu_[t]}) lq::copy_lower_to_upper(*Q);
}

bool RiccatiDirection::compute_gains(std::size_t t) {
  require(t == node_, "SolverDDP::computeGains", "call computeActionValueFunction for this node first");
  if (Qu_[t].size() == 0) return true;
  if (!riccati_.eliminate(L_[t], 0)) return false;
  K_[t] = riccati_.Kt().transpose();
  k_[t] = Qu_[t];
  lq::solve_L(L_[t], k_[t]);
  lq::solve_Lt(L_[t], k_[t]);
  return true;
}

void RiccatiDirection::compute_value_function(std::size_t t) {
  require(t == node_, "SolverDDP::computeValueFunction", "call computeActionValueFunction for this node first");
  Vx_[t] = Qx_[t];
  if (Qu_[t].size() > 0) {
    Quuk_[t].noalias() = riccati_.Qvv().selfadjointView<Eigen::Lower>() * k_[t];
    Vx_[t].noalias() -= K_[t].transpose() * Qu_[t];
    riccati_.Kt() = K_[t].transpose();
  }
  MatrixXd& V = value(t);
  riccati_.value(V);
  V.diagonal().array() += preg_;
  add_gap(t);
}

// Computes u = us - s k - K (x (-) xs) for the step length s.
void RiccatiDirection::step_control(std::size_t t, double steplength) {
  part_.problem->model(t)->get_state()->diff(xs_[t], xs_try_[t], dx_[t]);
  us_try_[t] = us_[t] - steplength * k_[t];
  us_try_[t].noalias() -= K_[t] * dx_[t];
  limit_control(t);
}

// Returns dg = sum Qu^T k - sum Vx^T fs and dq = - sum k^T Quu k + sum fs^T Vxx fs. Sums with fs require `gaps`.
Eigen::Vector2d RiccatiDirection::improvement(bool gaps) {
  Eigen::Vector2d d = Eigen::Vector2d::Zero();
  const std::size_t T = k_.size();
  const auto add_gap = [&](std::size_t t) {
    if (!gaps || is_feasible_) return;
    d[0] -= Vx_[t].dot(fs_[t]);
    d[1] += fs_[t].dot(Vxx_fs_[t]);
  };
  add_gap(T);
  for (std::size_t t = 0; t < T; ++t) {
    d[0] += Qu_[t].dot(k_[t]);
    d[1] -= k_[t].dot(Quuk_[t]);
    add_gap(t);
  }
  return d;
}

double RiccatiDirection::gap_improvement() {
  double dv = 0;
  if (is_feasible_) return dv;
  const std::size_t T = k_.size();
  for (std::size_t k = 0; k <= T; ++k) {
    const std::size_t t = k == 0 ? T : k - 1;  // the terminal node comes first, as in Crocoddyl
    part_.problem->model(t)->get_state()->diff(xs_try_[t], xs_[t], step_);
    dv -= Vxx_fs_[t].dot(step_);
  }
  return dv;
}

// Returns half the sum of Qu^T k, the reduction of the cost by a Newton step.
double RiccatiDirection::expected_reduction() const {
  double out = 0;
  for (std::size_t t = 0; t < k_.size(); ++t) out += 0.5 * Qu_[t].dot(k_[t]);
  return out;
}

void RiccatiDirection::feed_forward_gradient(Vectors& g) {
  const std::size_t T = k_.size();
  Vx_[T] = part_.problem->get_terminalData()->Lx;
  for (std::size_t t = T; t-- > 0;) {
    const ActionDataAbstract& d = *part_.problem->data(t);
    d.pull_back(Vx_[t + 1], Vx_[t], g[t]);
    g[t] += d.Lu;
    hold_controls(t, g[t]);
    Vx_[t] += d.Lx;
    Vx_[t].noalias() -= K_[t].transpose() * g[t];
  }
}

void RiccatiDirection::precondition_feed_forward(Vectors& g) {
  for (std::size_t t = 0; t < g.size(); ++t) {
    lq::solve_L(L_[t], g[t]);
    lq::solve_Lt(L_[t], g[t]);
  }
}

std::vector<Direction::Gains> RiccatiDirection::gains(std::size_t t) const { return {{part_.dx, part_.u[t], K_[t]}}; }

void BoxDirection::resize() {
  RiccatiDirection::resize();
  const std::size_t T = part_.problem->get_T();
  Quu_inv_.resize(T);
  held_.resize(T);
  for (std::size_t t = 0; t < T; ++t) {
    const Eigen::Index nu = k_[t].size();
    if (Quu_inv_[t].rows() != nu) Quu_inv_[t].setZero(nu, nu);
    held_[t].resize(static_cast<std::size_t>(nu));
  }
}

// Computes k with the box QP, and K = Quu^-1 Qxu^T of the free controls. For controls at limits, K and Qu become zero.
bool BoxDirection::compute_gains(std::size_t t) {
  const ActionModelAbstract& model = *part_.problem->model(t);
  if (model.get_nu() == 0) return true;
  if (!model.get_has_control_limits() || !is_feasible_) return RiccatiDirection::compute_gains(t);
  du_lb_ = model.get_u_lb() - us_[t];
  du_ub_ = model.get_u_ub() - us_[t];
  if (qp_.get_nx() != model.get_nu()) qp_.set_nx(model.get_nu());
  if (!qp_.minimise(Quu_[t], Qu_[t], du_lb_, du_ub_, k_[t])) return false;
  qp_.free_inverse(Quu_inv_[t]);
  K_[t].noalias() = Quu_inv_[t] * Qxu_[t].transpose();
  k_[t] = -qp_.get_solution().x;
  for (const std::size_t i : qp_.get_solution().clamped_idx) Qu_[t][i] = 0;
  return true;
}

void BoxDirection::limit_control(std::size_t t) { internal::keep_limits(*part_.problem->model(t), us_try_[t]); }

// Replaces g by Quu^-1 g with all of Quu, because the box QP's inverse is zero for clamped controls. Then zeroes the
// entries of controls at limits.
void BoxDirection::precondition_feed_forward(Vectors& g) {
  for (std::size_t t = 0; t < g.size(); ++t) {
    if (g[t].size() == 0) continue;
    if (part_.problem->model(t)->get_has_control_limits()) {
      L_[t] = Quu_[t];
      if (!lq::cholesky(L_[t], 0)) continue;
    }
    lq::solve_L(L_[t], g[t]);
    lq::solve_Lt(L_[t], g[t]);
  }
  hold_feed_forward(g);
}

void BoxDirection::hold_feed_forward(Vectors& nu) {
  for (std::size_t t = 0; t < nu.size(); ++t)
    for (Eigen::Index i = 0; i < nu[t].size(); ++i)
      if (held_[t][i]) nu[t][i] = 0;
}

void BoxDirection::hold_controls(std::size_t t, Eigen::VectorXd& g) {
  const ActionModelAbstract& model = *part_.problem->model(t);
  if (!model.get_has_control_limits()) return;
  const Eigen::VectorXd& u = us_try_[t];
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    const bool held = (u[i] <= model.get_u_lb()[i] && g[i] > 0) || (u[i] >= model.get_u_ub()[i] && g[i] < 0);
    if (held) g[i] = 0;
    if (held == held_[t][i]) continue;
    held_[t][i] = held;
    held_changed_ = true;
  }
}

}  // namespace manycontact
