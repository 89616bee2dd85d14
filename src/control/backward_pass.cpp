// The Riccati recursion of SolverDDP.

#include "manycontact/control/ddp.hpp"

namespace manycontact {

namespace {

// Lower triangle += A B, of a product that is symmetric.
template <class A, class B>
void add_symmetric(double sign, const A& a, const B& b, Eigen::MatrixXd& out) {
  out.triangularView<Eigen::Lower>() += sign * (a * b);
}

void mirror(Eigen::MatrixXd& out) { out.triangularView<Eigen::StrictlyUpper>() = out.transpose(); }

// Of the lower triangle and v: finite and below 1e30.
bool is_sound(const Eigen::MatrixXd& V, const Eigen::VectorXd& v) {
  double largest = 0;
  for (Eigen::Index j = 0; j < V.cols(); ++j) {
    double sum = std::abs(v[j]);
    for (Eigen::Index i = j; i < V.rows(); ++i) sum += std::abs(V(i, j));
    if (!(sum <= largest)) largest = sum;
    if (!(largest < 1e30)) return false;
  }
  return true;
}

}  // namespace

void SolverDDP::backwardPass() {
  const ActionDataAbstract& terminal = *problem_->get_terminalData();
  sound_ = true;
  Vxx_.back() = terminal.Lxx;
  Vx_.back() = terminal.Lx;
  Vxx_.back().diagonal().array() += preg_;
  if (!is_feasible_) Vx_.back().noalias() += Vxx_.back() * fs_.back();
  for (std::size_t t = problem_->get_T(); t-- > 0;) {
    const auto& model = problem_->get_runningModels()[t];
    computeActionValueFunction(t, model, problem_->get_runningDatas()[t]);
    computeGains(t);
    if (!sound_) return;
    computeValueFunction(t, model);
    if (!is_sound(Vxx_[t], Vx_[t])) {
      sound_ = false;
      return;
    }
  }
}

void SolverDDP::computeActionValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model,
                                           const std::shared_ptr<ActionDataAbstract>& data) {
  require(t < problem_->get_T(), "SolverDDP::computeActionValueFunction", "there is no such node");
  const Eigen::MatrixXd &Fx = data->Fx, &Fu = data->Fu, &V = Vxx_[t + 1];
  const Eigen::VectorXd& v = Vx_[t + 1];
  VxxFx_.noalias() = V * Fx;
  Qx_[t] = data->Lx;
  Qx_[t].noalias() += Fx.transpose() * v;
  Qxx_[t] = data->Lxx;
  add_symmetric(1, Fx.transpose(), VxxFx_, Qxx_[t]);
  mirror(Qxx_[t]);
  if (model->get_nu() == 0) return;
  VxxFu_.resize(V.rows(), Fu.cols());
  VxxFu_.noalias() = V * Fu;
  Qu_[t] = data->Lu;
  Qu_[t].noalias() += Fu.transpose() * v;
  Quu_[t] = data->Luu;
  add_symmetric(1, Fu.transpose(), VxxFu_, Quu_[t]);
  mirror(Quu_[t]);
  Quu_[t].diagonal().array() += preg_;
  Qxu_[t] = data->Lxu;
  Qxu_[t].noalias() += Fx.transpose() * VxxFu_;
}

void SolverDDP::computeGains(std::size_t t) {
  require(t < problem_->get_T(), "SolverDDP::computeGains", "there is no such node");
  if (problem_->get_runningModels()[t]->get_nu() == 0) return;
  Quu_llt_[t].compute(Quu_[t]);
  if (Quu_llt_[t].info() != Eigen::Success) {
    sound_ = false;
    return;
  }
  K_[t] = Qxu_[t].transpose();
  Quu_llt_[t].solveInPlace(K_[t]);
  k_[t] = Qu_[t];
  Quu_llt_[t].solveInPlace(k_[t]);
}

void SolverDDP::computeValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model) {
  require(t < problem_->get_T(), "SolverDDP::computeValueFunction", "there is no such node");
  Vx_[t] = Qx_[t];
  Vxx_[t] = Qxx_[t];
  if (model->get_nu() != 0) {
    Quuk_[t].noalias() = Quu_[t] * k_[t];
    Vx_[t].noalias() -= K_[t].transpose() * Qu_[t];
    add_symmetric(-1, Qxu_[t], K_[t], Vxx_[t]);
    mirror(Vxx_[t]);
  }
  Vxx_[t].diagonal().array() += preg_;
  if (!is_feasible_) Vx_[t].noalias() += Vxx_[t] * fs_[t];
}

}  // namespace manycontact
