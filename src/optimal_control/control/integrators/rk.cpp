#include "manycontact/control/rk.hpp"

#include "steps.hpp"

namespace manycontact {

IntegratedActionDataRK::IntegratedActionDataRK(IntegratedActionModelRK* model) : IntegratedActionDataAbstract(model) {
  const std::size_t ni = model->get_ni();
  const Eigen::Index nx = model->get_state()->get_nx(), ndx = model->get_state()->get_ndx(), nu = model->get_nu();
  const Eigen::Index nw = model->get_control()->get_nw(), nv = ndx / 2;
  for (std::size_t i = 0; i < ni; ++i) {
    differential.push_back(model->get_differential()->createData());
    control.push_back(model->get_control()->createData());
  }
  integral.assign(ni, 0);
  ki.assign(ni, Eigen::VectorXd::Zero(ndx));
  y.assign(ni, Eigen::VectorXd::Zero(nx));
  ws.assign(ni, Eigen::VectorXd::Zero(nw));
  dx_rk.assign(ni, Eigen::VectorXd::Zero(ndx));
  dki_dx.assign(ni, Eigen::MatrixXd::Zero(ndx, ndx));
  dki_du.assign(ni, Eigen::MatrixXd::Zero(ndx, nu));
  dyi_dx.assign(ni, Eigen::MatrixXd::Zero(ndx, ndx));
  dyi_du.assign(ni, Eigen::MatrixXd::Zero(ndx, nu));
  dyi_dx[0].setIdentity();
  dki_dx[0].topRightCorner(nv, nv).setIdentity();
  dx.setZero(ndx);
  Lxx_dx.setZero(ndx, ndx);
  Lxu_i.setZero(ndx, nu);
  Lwu.setZero(nw, nu);
  Luu_i.setZero(nu, nu);
  Lu_i.setZero(nu);
}

namespace {

std::vector<double> times(RKType type) {
  if (type == two) return {0, 0.5};
  if (type == three) return {0, 1.0 / 3, 2.0 / 3};
  return {0, 0.5, 0.5, 1};
}
std::vector<double> weights(RKType type) {
  if (type == two) return {0, 1};
  if (type == three) return {0.25, 0, 0.75};
  return {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
}

// Computes the derivatives of stage i's acceleration k_i and state y_i with respect to x and u.
void differentiate_stage(const StateAbstract& state, const ControlParametrizationModelAbstract& control,
                         const ConstVectorRef& x, double step, std::size_t i, IntegratedActionDataRK& d) {
  const Eigen::Index nv = state.get_nv();
  const DifferentialActionDataAbstract& k = *d.differential[i];
  if (i == 0) {  // stage 0: y = x, dv/dx = [0 I]
    d.dki_dx[0].bottomRows(nv) = k.Fx;
    control.multiplyByJacobian(d.control[0], k.Fu, d.dki_du[0].bottomRows(nv));
    return;
  }
  Eigen::MatrixXd &dy_dx = d.dyi_dx[i], &dy_du = d.dyi_du[i];
  dy_dx = step * d.dki_dx[i - 1];
  dy_du = step * d.dki_du[i - 1];
  state.JintegrateTransport(x, d.dx_rk[i], dy_dx, second);
  state.Jintegrate(x, d.dx_rk[i], dy_dx, dy_dx, first, addto);
  state.JintegrateTransport(x, d.dx_rk[i], dy_du, second);
  d.dki_dx[i].topRows(nv) = dy_dx.bottomRows(nv);
  d.dki_dx[i].bottomRows(nv).noalias() = k.Fx * dy_dx;
  d.dki_du[i].topRows(nv) = dy_du.bottomRows(nv);
  d.dki_du[i].bottomRows(nv).noalias() = k.Fx * dy_du;
  control.multiplyByJacobian(d.control[i], k.Fu, d.dki_du[i].bottomRows(nv), addto);
}

// Adds the derivatives of stage i's cost l(y(x, u), w(u)). The first factor w in each term is the weight of the stage.
//     Lx  += w y_x^T l_x                   Lu  += w (y_u^T l_x + w_u^T l_w)
//     Lxx += w y_x^T l_xx y_x              Lxu += w y_x^T (l_xx y_u + l_xw w_u)
//     Luu += w (y_u^T (l_xx y_u + l_xw w_u) + (l_xw w_u)^T y_u + w_u^T l_ww w_u)
void add_stage_cost(const ControlParametrizationModelAbstract& control, double w, std::size_t i,
                    IntegratedActionDataRK& d) {
  const DifferentialActionDataAbstract& l = *d.differential[i];
  const Eigen::MatrixXd &y_x = d.dyi_dx[i], &y_u = d.dyi_du[i];
  control.multiplyJacobianTransposeBy(d.control[i], l.Lu, d.Lu_i);
  control.multiplyByJacobian(d.control[i], l.Luu, d.Lwu);
  control.multiplyJacobianTransposeBy(d.control[i], d.Lwu, d.Luu_i);
  control.multiplyByJacobian(d.control[i], l.Lxu, d.Lxu_i);
  d.Lu += w * d.Lu_i;
  d.Luu += w * d.Luu_i;
  if (i == 0) {
    d.Lx += w * l.Lx;
    d.Lxx += w * l.Lxx;
    d.Lxu += w * d.Lxu_i;
    return;
  }
  d.Lx.noalias() += w * (y_x.transpose() * l.Lx);
  d.Lu.noalias() += w * (y_u.transpose() * l.Lx);
  d.Luu.noalias() += w * (d.Lxu_i.transpose() * y_u);
  d.Lxx_dx.noalias() = l.Lxx * y_x;
  d.Lxu_i.noalias() += l.Lxx * y_u;
  d.Lxx.noalias() += w * (y_x.transpose() * d.Lxx_dx);
  d.Lxu.noalias() += w * (y_x.transpose() * d.Lxu_i);
  d.Luu.noalias() += w * (y_u.transpose() * d.Lxu_i);
}

}  // namespace

IntegratedActionModelRK::IntegratedActionModelRK(std::shared_ptr<DifferentialActionModelAbstract> model,
                                                 std::shared_ptr<ControlParametrizationModelAbstract> control,
                                                 RKType rktype, double time_step, bool with_cost_residual)
    : NodeWithData(std::move(model), std::move(control), time_step, with_cost_residual),
      c_(times(rktype)),
      b_(weights(rktype)) {}

IntegratedActionModelRK::IntegratedActionModelRK(std::shared_ptr<DifferentialActionModelAbstract> model, RKType rktype,
                                                 double time_step, bool with_cost_residual)
    : NodeWithData(std::move(model), time_step, with_cost_residual), c_(times(rktype)), b_(weights(rktype)) {}

void IntegratedActionModelRK::evaluate(IntegratedActionDataRK& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  if (!u) return calc_terminal(x, d);
  const Eigen::Index nv = state_->get_nv();
  d.dx.setZero();
  d.cost = 0;
  for (std::size_t i = 0; i < c_.size(); ++i) {
    if (i == 0) {
      d.y[i] = x;
    } else {
      d.dx_rk[i] = time_step_ * c_[i] * d.ki[i - 1];
      state_->integrate(x, d.dx_rk[i], d.y[i]);
    }
    control_->calc(d.control[i], c_[i], *u);
    d.ws[i] = d.control[i]->w;
    differential_->calc(d.differential[i], d.y[i], d.ws[i]);
    d.ki[i].head(nv) = d.y[i].tail(nv);
    d.ki[i].tail(nv) = d.differential[i]->xout;
    d.integral[i] = d.differential[i]->cost;
    if (b_[i] == 0) continue;
    d.dx += time_step_ * b_[i] * d.ki[i];
    d.cost += time_step_ * b_[i] * d.integral[i];
  }
  state_->integrate(x, d.dx, d.xnext);
  internal::copy_values(*d.differential[0], with_cost_residual_, d);
}

void IntegratedActionModelRK::differentiate(IntegratedActionDataRK& d, const ConstVectorRef& x,
                                            const ConstVectorRef* u) {
  if (!u) return calcDiff_terminal(x, d);
  d.Fx.setZero(), d.Fu.setZero();
  d.Lx.setZero(), d.Lu.setZero();
  d.Lxx.setZero(), d.Lxu.setZero(), d.Luu.setZero();
  for (std::size_t i = 0; i < c_.size(); ++i) {
    differential_->calcDiff(d.differential[i], d.y[i], d.ws[i]);
    internal::check_dense("IntegratedActionModelRK::calcDiff", *d.differential[i]);
    differentiate_stage(*state_, *control_, x, time_step_ * c_[i], i, d);
    if (b_[i] == 0) continue;
    d.Fx += time_step_ * b_[i] * d.dki_dx[i];
    d.Fu += time_step_ * b_[i] * d.dki_du[i];
    add_stage_cost(*control_, time_step_ * b_[i], i, d);
  }
  state_->JintegrateTransport(x, d.dx, d.Fx, second);
  state_->Jintegrate(x, d.dx, d.Fx, d.Fx, first, addto);
  state_->JintegrateTransport(x, d.dx, d.Fu, second);
  internal::copy_constraint_derivatives(*control_, d.control[0], *d.differential[0], d);
}

bool IntegratedActionModelRK::checkData(const DataPtr& data) {
  const auto* d = dynamic_cast<IntegratedActionDataRK*>(data.get());
  return d && d->stages() == c_.size() && NodeWithData::checkData(data);
}

}  // namespace manycontact
