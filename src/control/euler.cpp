#include "manycontact/control/euler.hpp"

#include <typeinfo>

#include "manycontact/control/state_vector.hpp"
#include "steps.hpp"

namespace manycontact {

using DataPtr = std::shared_ptr<ActionDataAbstract>;
using internal::own_data;

IntegratedActionDataEuler::IntegratedActionDataEuler(IntegratedActionModelEuler* model)
    : ActionDataAbstract(model),
      differential(model->get_differential()->createData()),
      control(model->get_control()->createData()),
      dx(Eigen::VectorXd::Zero(model->get_state()->get_ndx())),
      da_du(Eigen::MatrixXd::Zero(model->get_state()->get_nv(), model->get_nu())),
      Lwu(Eigen::MatrixXd::Zero(model->get_control()->get_nw(), model->get_nu())) {
  const StateAbstract* state = model->get_state().get();
  joints_are_known = typeid(*state) == typeid(StateVector) || typeid(*state) == typeid(StateMultibody);
  if (typeid(*state) != typeid(StateMultibody)) return;
  for (const Robot& robot : static_cast<const StateMultibody*>(state)->get_model()->scene().robots)
    for (const Joint& joint : robot.model->joints)
      if (joint.nv() > 1)
        wide_joints.push_back(
            {robot.idx_v + joint.idx_v, joint.nv(), Mat6<double>::Identity(), Mat6<double>::Identity()});
  if (!wide_joints.empty()) joint_columns.setZero(state->get_ndx(), 6);
}

namespace {

// The joints' blocks of J1 or J2, by their action on identities.
void differentiate_joints(const StateAbstract& state, const ConstVectorRef& x, IntegratedActionDataEuler& d) {
  if (d.wide_joints.empty()) return;
  for (const Jcomponent which : {first, second}) {
    for (const IntegratedActionDataEuler::WideJoint& joint : d.wide_joints)
      d.joint_columns.block(joint.first, 0, joint.size, joint.size).setIdentity();
    state.JintegrateTransport(x, d.dx, d.joint_columns, which);
    for (IntegratedActionDataEuler::WideJoint& joint : d.wide_joints)
      (which == first ? joint.of_x : joint.of_dx).topLeftCorner(joint.size, joint.size) =
          d.joint_columns.block(joint.first, 0, joint.size, joint.size);
  }
}

}  // namespace

void IntegratedActionModelEuler::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("IntegratedActionModelEuler::calc", x, u);
  IntegratedActionDataEuler& d = own_data<IntegratedActionDataEuler>("IntegratedActionModelEuler::calc", data);
  const Eigen::Index nv = state_->get_nv();
  control_->calc(d.control, 0, u);
  differential_->calc(d.differential, x, d.control->w);
  const Eigen::VectorXd& a = d.differential->xout;
  d.dx.head(nv) = time_step_ * x.tail(nv) + time_step2_ * a;
  d.dx.tail(nv) = time_step_ * a;
  state_->integrate(x, d.dx, d.xnext);
  d.cost = time_step_ * d.differential->cost;
  internal::copy_values(*d.differential, with_cost_residual_, d);
}

void IntegratedActionModelEuler::calc(const DataPtr& data, const ConstVectorRef& x) {
  check("IntegratedActionModelEuler::calc", x);
  IntegratedActionDataEuler& d = own_data<IntegratedActionDataEuler>("IntegratedActionModelEuler::calc", data);
  differential_->calc(d.differential, x);
  d.dx.setZero();
  d.xnext = x;
  d.cost = d.differential->cost;
  internal::copy_values(*d.differential, with_cost_residual_, d);
}

// With J1, J2 of x (+) dx:    Fx = J1 + J2 [h^2 a_x + h [0 I]; h a_x],    Fu = J2 [h^2 a_u; h a_u]
void IntegratedActionModelEuler::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("IntegratedActionModelEuler::calcDiff", x, u);
  IntegratedActionDataEuler& d = own_data<IntegratedActionDataEuler>("IntegratedActionModelEuler::calcDiff", data);
  const DifferentialActionDataAbstract& a = *d.differential;
  const Eigen::Index nv = state_->get_nv();
  const double h = time_step_;
  differential_->calcDiff(d.differential, x, d.control->w);
  internal::check_dense("IntegratedActionModelEuler::calcDiff", a);
  control_->multiplyByJacobian(d.control, a.Fu, d.da_du);
  d.Fx.topRows(nv) = time_step2_ * a.Fx;
  d.Fx.bottomRows(nv) = h * a.Fx;
  d.Fx.topRightCorner(nv, nv).diagonal().array() += h;
  d.Fu.topRows(nv) = time_step2_ * d.da_du;
  d.Fu.bottomRows(nv) = h * d.da_du;
  state_->JintegrateTransport(x, d.dx, d.Fx, second);
  state_->Jintegrate(x, d.dx, d.Fx, d.Fx, first, addto);
  state_->JintegrateTransport(x, d.dx, d.Fu, second);
  differentiate_joints(*state_, x, d);

  d.Lx = h * a.Lx;
  d.Lxx = h * a.Lxx;
  control_->multiplyJacobianTransposeBy(d.control, a.Lu, d.Lu);
  control_->multiplyByJacobian(d.control, a.Lxu, d.Lxu);
  control_->multiplyByJacobian(d.control, a.Luu, d.Lwu);
  control_->multiplyJacobianTransposeBy(d.control, d.Lwu, d.Luu);
  d.Lu *= h, d.Lxu *= h, d.Luu *= h;
  internal::copy_constraint_derivatives(*control_, d.control, a, d);
}

void IntegratedActionModelEuler::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  check("IntegratedActionModelEuler::calcDiff", x);
  IntegratedActionDataEuler& d = own_data<IntegratedActionDataEuler>("IntegratedActionModelEuler::calcDiff", data);
  differential_->calcDiff(d.differential, x);
  internal::copy_terminal_derivatives(*d.differential, d);
}

DataPtr IntegratedActionModelEuler::createData() { return std::make_shared<IntegratedActionDataEuler>(this); }

bool IntegratedActionModelEuler::checkData(const DataPtr& data) {
  const auto* d = dynamic_cast<IntegratedActionDataEuler*>(data.get());
  return d && differential_->checkData(d->differential);
}

void IntegratedActionModelEuler::quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x,
                                             std::size_t maxiter, double tol) {
  check("IntegratedActionModelEuler::quasiStatic", x, u);
  IntegratedActionDataEuler& d = own_data<IntegratedActionDataEuler>("IntegratedActionModelEuler::quasiStatic", data);
  differential_->quasiStatic(d.differential, d.control->w, x, maxiter, tol);
  control_->params(d.control, 0, d.control->w);
  u = d.control->u;
}

void IntegratedActionModelEuler::print(std::ostream& os) const { print_as("IntegratedActionModelEuler", os); }

}  // namespace manycontact
