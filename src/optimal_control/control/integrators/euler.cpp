#include "manycontact/control/euler.hpp"

#include <type_traits>
#include <typeinfo>

#include "euler_steps.hpp"
#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/detail/control/state_vector.hpp"
#include "steps.hpp"

namespace manycontact {

namespace {

// Calls use(first coordinate, size, J1, J2) for each floating or planar joint, with its diagonal blocks of the
// derivatives J1, J2 of x (+) dx. Sizes are compile-time constants.
template <class Use>
void each_wide_joint(const IntegratedActionDataEuler& data, Use&& use) {
  for (const IntegratedActionDataEuler::WideJoint& joint : data.wide_joints) {
    if (joint.size == 6)
      use(joint.first, std::integral_constant<int, 6>(), joint.of_x, joint.of_dx);
    else
      use(joint.first, std::integral_constant<int, 3>(), Mat3<double>(joint.of_x.topLeftCorner<3, 3>()),
          Mat3<double>(joint.of_dx.topLeftCorner<3, 3>()));
  }
}

}  // namespace

IntegratedActionDataEuler::IntegratedActionDataEuler(IntegratedActionModelEuler* model)
    : IntegratedActionDataAbstract(model, WithoutMatrices{}),
      differential(model->get_differential()->createData()),
      control(model->get_control()->createData()) {
  const StateAbstract* state = model->get_state().get();
  dx.setZero(state->get_ndx());
  joints_are_known = typeid(*state) == typeid(StateVector) || typeid(*state) == typeid(StateMultibody);
  if (has_matrices()) {
    allocate_matrices(model);
    da_du.setZero(state->get_nv(), model->get_nu());
    Lwu.setZero(model->get_control()->get_nw(), model->get_nu());
  } else {
    const ControlParametrizationModelAbstract& parametrization = *model->get_control();
    require(model->get_nu() > 0 && dynamic_cast<const DifferentialActionDataContactFwdDynamics*>(differential.get()),
            "IntegratedActionModelEuler", "storage kPanel requires contact dynamics with controls: kDense is expected");
    require(g.size() + h.size() == 0 && joints_are_known &&
                typeid(parametrization) == typeid(ControlParametrizationModelPolyZero),
            "IntegratedActionModelEuler",
            "storage kPanel requires a StateVector or StateMultibody, controls that are constant over a step, and no "
            "constraints: kDense is expected");
    Lx.setZero(state->get_ndx());
    Lu.setZero(model->get_nu());
    pulled.setZero(state->get_nv());
  }
  if (typeid(*state) != typeid(StateMultibody)) return;
  for (const Robot& robot : static_cast<const StateMultibody*>(state)->get_model()->scene().robots)
    for (const Joint& joint : robot.model->joints)
      if (joint.nv() > 1)
        wide_joints.push_back(
            {robot.idx_v + joint.idx_v, joint.nv(), Mat6<double>::Identity(), Mat6<double>::Identity()});
  if (!wide_joints.empty()) joint_columns.setZero(state->get_ndx(), 6);
}

const PanelView& IntegratedActionDataEuler::panel() const {
  if (!differential->panel.data())
    throw std::logic_error("IntegratedActionDataEuler: there are no derivatives, call calcDiff first");
  return differential->panel;
}

// Computes gx = Fx^T p and gu = Fu^T p from the panel [a_x a_u] of derivatives of the acceleration, for p = [p_q; p_v]:
// gx = h a_x^T g + [J1^T p_q; g] and gu = h a_u^T g, where g = h J2^T p_q + p_v.
void IntegratedActionDataEuler::pull_back(const Eigen::VectorXd& p, VectorRef gx, VectorRef gu) const {
  if (has_matrices()) return ActionDataAbstract::pull_back(p, gx, gu);
  const Eigen::Index nv = pulled.size();
  const PanelView& a = panel();
  gx = p;
  pulled = step * p.head(nv) + p.tail(nv);
  each_wide_joint(*this, [&](Eigen::Index q, auto size, const auto& J1, const auto& J2) {
    constexpr int k = size.value;
    gx.segment<k>(q) = J1.transpose() * p.segment<k>(q);
    pulled.segment<k>(q) = step * (J2.transpose() * p.segment<k>(q)) + p.segment<k>(nv + q);
  });
  gx.tail(nv) = pulled;
  gx.noalias() += step * (a.leftCols(2 * nv).transpose() * pulled);
  gu.noalias() = step * (a.rightCols(a.cols() - 2 * nv).transpose() * pulled);
}

void IntegratedActionDataEuler::dynamics(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const {
  if (has_matrices()) return ActionDataAbstract::dynamics(fx, fu);
  const Eigen::Index nv = pulled.size();
  const PanelView& a = panel();
  fx.resize(2 * nv, 2 * nv);
  fu.resize(2 * nv, a.cols() - 2 * nv);
  fx.bottomRows(nv) = step * a.leftCols(2 * nv);
  fu.bottomRows(nv) = step * a.rightCols(fu.cols());
  integrate_velocities(fx, fu);
}

// Computes Fx, Fu with the derivatives J1, J2 of x (+) dx, from h a_x and h a_u in the lower halves of fx and fu:
//
//     Fx = [J1 0; 0 0] + [h J2; 1] (h a_x + [0 I]),    Fu = [h J2; 1] h a_u
void IntegratedActionDataEuler::integrate_velocities(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const {
  const Eigen::Index nv = fx.rows() / 2;
  fx.bottomRightCorner(nv, nv).diagonal().array() += 1;
  fx.topRows(nv) = step * fx.bottomRows(nv);
  fu.topRows(nv) = step * fu.bottomRows(nv);
  fx.topLeftCorner(nv, nv).diagonal().array() += 1;
  each_wide_joint(*this, [&](Eigen::Index q, auto size, const auto& J1, const auto& J2) {
    constexpr int k = size.value;
    fx.middleRows<k>(q) = step * J2.lazyProduct(fx.middleRows<k>(nv + q));
    fu.middleRows<k>(q) = step * J2.lazyProduct(fu.middleRows<k>(nv + q));
    fx.template block<k, k>(q, q) += J1;
  });
}

void IntegratedActionModelEuler::evaluate(IntegratedActionDataEuler& d, const ConstVectorRef& x,
                                          const ConstVectorRef* u) {
  if (!u) return calc_terminal(x, d);
  control_->calc(d.control, 0, *u);
  differential_->calc(d.differential, x, d.control->w);
  const Eigen::Index nv = state_->get_nv();
  const Eigen::VectorXd& a = d.differential->xout;
  d.dx.head(nv) = time_step_ * x.tail(nv) + time_step_ * time_step_ * a;
  d.dx.tail(nv) = time_step_ * a;
  state_->integrate(x, d.dx, d.xnext);
  d.cost = time_step_ * d.differential->cost;
  internal::copy_values(*d.differential, with_cost_residual_, d);
}

namespace {

// Computes the blocks of J1 and J2 of floating and planar joints, by applying JintegrateTransport to identity matrices.
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

// Computes the following Fx and Fu, where J1 and J2 are the derivatives of x (+) dx by x and dx, and h is the step.
//     Fx = J1 + J2 [h^2 a_x + h [0 I]; h a_x]        Fu = J2 [h^2 a_u; h a_u]
void IntegratedActionModelEuler::differentiate(IntegratedActionDataEuler& d, const ConstVectorRef& x,
                                               const ConstVectorRef* u) {
  if (!u) return calcDiff_terminal(x, d);
  const DifferentialActionDataAbstract& a = *d.differential;
  const Eigen::Index nv = state_->get_nv();
  const double h = time_step_;
  differential_->calcDiff(d.differential, x, d.control->w);
  d.step = h;
  differentiate_joints(*state_, x, d);
  if (!d.has_matrices()) {
    d.Lx = h * a.Lx;
    d.Lu = h * a.Lu;
    return;
  }
  internal::check_dense("IntegratedActionModelEuler::calcDiff", a);
  control_->multiplyByJacobian(d.control, a.Fu, d.da_du);
  d.Fx.bottomRows(nv) = h * a.Fx;
  d.Fu.bottomRows(nv) = h * d.da_du;
  if (d.joints_are_known) {
    d.integrate_velocities(d.Fx, d.Fu);
  } else {
    d.Fx.topRows(nv) = time_step2_ * a.Fx;
    d.Fx.topRightCorner(nv, nv).diagonal().array() += h;
    d.Fu.topRows(nv) = time_step2_ * d.da_du;
    state_->JintegrateTransport(x, d.dx, d.Fx, second);
    state_->Jintegrate(x, d.dx, d.Fx, d.Fx, first, addto);
    state_->JintegrateTransport(x, d.dx, d.Fu, second);
  }
  internal::integrate_cost_derivatives(h, *control_, d.control, a, d.Lwu, d);
  internal::copy_constraint_derivatives(*control_, d.control, a, d);
}

namespace internal {

const IntegratedActionDataEuler* find_euler(const ActionDataAbstract& node) {
  const auto* augmented = dynamic_cast<const ActionDataAugmentedLagrangian*>(&node);
  return dynamic_cast<const IntegratedActionDataEuler*>(augmented ? augmented->inner.get() : &node);
}

const IntegratedActionDataEuler* known_steps(const ActionModelAbstract& model, const ActionDataAbstract& node) {
  const IntegratedActionDataEuler* euler = find_euler(node);
  if (!euler || !euler->joints_are_known) return nullptr;
  const auto* augmented = dynamic_cast<const ActionModelAugmentedLagrangian*>(&model);
  const ActionModelAbstract& own = augmented ? *augmented->get_model() : model;
  return !node.has_matrices() || typeid(own) == typeid(IntegratedActionModelEuler) ? euler : nullptr;
}

void fill_steps(const IntegratedActionDataEuler& euler, lq::SymplecticStructure& out) {
  const auto fill = [&](lq::BlockDiagonal& D, double scale, Mat6<double> IntegratedActionDataEuler::WideJoint::*which) {
    D.scale = scale;
    D.parts.resize(euler.wide_joints.size());
    for (std::size_t k = 0; k < D.parts.size(); ++k) {
      const IntegratedActionDataEuler::WideJoint& joint = euler.wide_joints[k];
      D.parts[k].first = joint.first;
      D.parts[k].block = scale * (joint.*which).topLeftCorner(joint.size, joint.size);
    }
  };
  fill(out.J, 1, &IntegratedActionDataEuler::WideJoint::of_x);
  fill(out.G, euler.step, &IntegratedActionDataEuler::WideJoint::of_dx);
}

}  // namespace internal

}  // namespace manycontact
