#include "manycontact/control/box_solvers.hpp"

#include "manycontact/control/sparse.hpp"

namespace manycontact {

template <class Base>
SolverWithBox<Base>::SolverWithBox(typename Base::Source source)
    : Base(std::move(source)), qp_(this->problem_->get_runningModels()[0]->get_nu(), 100, 0.1, 1e-5, 0) {
  this->keeps_values_ = true;
  SolverWithBox::allocateData();
  // The multipliers of the limits are not part of the expected improvement, which stays larger than without limits.
  this->th_stop_ = 5e-5;
}

template <class Base>
void SolverWithBox<Base>::allocateData() {
  Base::allocateData();
  const std::size_t T = this->problem_->get_T();
  Quu_inv_.resize(T);
  held_.resize(T);
  for (std::size_t t = 0; t < T; ++t) {
    const Eigen::Index nu = this->problem_->get_runningModels()[t]->get_nu();
    if (Quu_inv_[t].rows() != nu) Quu_inv_[t].setZero(nu, nu);
    held_[t].resize(static_cast<std::size_t>(nu));
  }
}

// k: the box QP's answer; K: Quu^-1 Qxu^T of the free controls, zero of those at a limit. Qu at limits is set to zero:
// it is balanced by the limit's multiplier.
template <class Base>
void SolverWithBox<Base>::computeGains(std::size_t t) {
  require(t < this->problem_->get_T(), "SolverBox::computeGains", "there is no such node");
  const ActionModelAbstract& model = *this->problem_->get_runningModels()[t];
  if (model.get_nu() == 0) return;
  if (!model.get_has_control_limits() || !this->is_feasible_) {
    Base::computeGains(t);
    return;
  }
  du_lb_ = model.get_u_lb() - this->us_[t];
  du_ub_ = model.get_u_ub() - this->us_[t];
  if (qp_.get_nx() != model.get_nu()) qp_.set_nx(model.get_nu());
  if (!qp_.minimise(this->Quu_[t], this->Qu_[t], du_lb_, du_ub_, this->k_[t])) {
    this->sound_ = false;
    return;
  }
  qp_.free_inverse(Quu_inv_[t]);
  this->K_[t].noalias() = Quu_inv_[t] * this->Qxu_[t].transpose();
  this->k_[t] = -qp_.get_solution().x;
  for (std::size_t i : qp_.get_solution().clamped_idx) this->Qu_[t][i] = 0;
}

template <class Base>
void SolverWithBox<Base>::limitControl(std::size_t t) {
  const ActionModelAbstract& model = *this->problem_->get_runningModels()[t];
  if (model.get_has_control_limits())
    this->us_try_[t] = this->us_try_[t].cwiseMax(model.get_u_lb()).cwiseMin(model.get_u_ub());
}

// Of controls that do not stand at a limit: those that the box QP took to one would not move at all.
template <class Base>
void SolverWithBox<Base>::preconditionFeedForward(std::vector<Eigen::VectorXd>& g) {
  for (std::size_t t = 0; t < g.size(); ++t) {
    if (g[t].size() == 0) continue;
    auto& llt = this->Quu_llt_[t];
    if (this->problem_->get_runningModels()[t]->get_has_control_limits()) llt.compute(this->Quu_[t]);
    if (llt.info() == Eigen::Success) llt.solveInPlace(g[t]);
  }
  holdFeedForward(g);
}

template <class Base>
void SolverWithBox<Base>::holdFeedForward(std::vector<Eigen::VectorXd>& nu) {
  for (std::size_t t = 0; t < nu.size(); ++t)
    for (Eigen::Index i = 0; i < nu[t].size(); ++i)
      if (held_[t][static_cast<std::size_t>(i)]) nu[t][i] = 0;
}

template <class Base>
void SolverWithBox<Base>::holdControls(std::size_t t, Eigen::VectorXd& g) {
  const ActionModelAbstract& model = *this->problem_->get_runningModels()[t];
  if (!model.get_has_control_limits()) return;
  const Eigen::VectorXd& u = this->us_try_[t];
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    const bool held = (u[i] <= model.get_u_lb()[i] && g[i] > 0) || (u[i] >= model.get_u_ub()[i] && g[i] < 0);
    if (held) g[i] = 0;
    if (held == held_[t][static_cast<std::size_t>(i)]) continue;
    held_[t][static_cast<std::size_t>(i)] = held;
    this->held_changed_ = true;
  }
}

template class SolverWithBox<SolverDDP>;
template class SolverWithBox<SolverFDDP>;
template class SolverWithBox<SolverSparsePart>;

// The terminal gap closes by the step length, as in Crocoddyl.
void SolverBoxDDP::forwardPass(double steplength) { rollOut(steplength, false, !is_feasible_ && steplength != 1); }

}  // namespace manycontact
