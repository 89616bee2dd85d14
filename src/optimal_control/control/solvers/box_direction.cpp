#include "../../lq/dense.hpp"
#include "manycontact/control/riccati_direction.hpp"

namespace manycontact {

using Vectors = Direction::Vectors;

BoxDirection::BoxDirection(ShootingPart part, bool is_whole)
    : RiccatiDirection(std::move(part), is_whole, true), qp_(part_.problem->model(0)->get_nu(), 100, 0.1, 1e-5, 0) {}

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

// k is the solution of the box QP, and K = Quu^-1 Qxu^T for the free controls, zero for those at a limit. Qu at limits
// is set to zero: the multiplier of the limit balances it.
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

void BoxDirection::limit_control(std::size_t t) {
  const ActionModelAbstract& model = *part_.problem->model(t);
  if (model.get_has_control_limits()) us_try_[t] = us_try_[t].cwiseMax(model.get_u_lb()).cwiseMin(model.get_u_ub());
}

// Uses controls that are not at a limit: those that the box QP moved to a limit would not move at all.
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
