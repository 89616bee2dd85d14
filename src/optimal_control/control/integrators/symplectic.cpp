#include "manycontact/control/symplectic.hpp"

#include <typeinfo>

#include "../../action/contacts/contact_columns.hpp"
#include "held_velocities.hpp"
#include "manycontact/control/free_fwddyn.hpp"
#include "steps.hpp"

namespace manycontact {

using SymplecticModel = IntegratedActionModelSymplectic;
using SymplecticData = IntegratedActionDataSymplectic;
using internal::HeldVelocities;

namespace {

const DataCollector& dynamics_of(const DifferentialActionDataAbstract& data) {
  return *static_cast<const DifferentialActionDataContactFwdDynamics&>(data).multibody;
}

std::shared_ptr<DifferentialActionModelAbstract> of_contact_dynamics(
    std::shared_ptr<DifferentialActionModelAbstract> model) {
  const auto* own = model.get();
  require(!own || typeid(*own) == typeid(DifferentialActionModelContactFwdDynamics) ||
              typeid(*own) == typeid(DifferentialActionModelFreeFwdDynamics),
          SymplecticModel::kName,
          "DifferentialActionModelContactFwdDynamics or DifferentialActionModelFreeFwdDynamics is expected: for other "
          "dynamics, and for classes derived from these two, use IntegratedActionModelEuler");
  return model;
}

// Updates the workspace `held`. Returns whether it fits the current robots and contacts of the data.
bool is_of(HeldVelocities& held, const DataCollector& of, double h) {
  if (!held.serve(of, h)) return false;
  for (std::size_t c = 0; c < of.scene.contacts.size(); ++c)
    if (!internal::have_same_rows(held.scene.contacts[c], of.scene.contacts[c])) return false;
  return true;
}

}  // namespace

SymplecticModel::IntegratedActionModelSymplectic(std::shared_ptr<DifferentialActionModelAbstract> model,
                                                 std::shared_ptr<ControlParametrizationModelAbstract> control,
                                                 double time_step, bool with_cost_residual)
    : NodeWithData(of_contact_dynamics(std::move(model)), std::move(control), time_step, with_cost_residual) {}

SymplecticModel::IntegratedActionModelSymplectic(std::shared_ptr<DifferentialActionModelAbstract> model,
                                                 double time_step, bool with_cost_residual)
    : NodeWithData(of_contact_dynamics(std::move(model)), time_step, with_cost_residual) {}

SymplecticData::IntegratedActionDataSymplectic(SymplecticModel* model)
    : IntegratedActionDataAbstract(model),
      differential(model->get_differential()->createData()),
      control(model->get_control()->createData()) {
  const Eigen::Index ndx = model->get_state()->get_ndx();
  const std::size_t nw = model->get_control()->get_nw();
  internal::check_dense(SymplecticModel::kName, *differential);
  dx.setZero(ndx);
  F.setZero(ndx, ndx + static_cast<Eigen::Index>(nw));
  Lwu.setZero(nw, model->get_nu());
  held = std::make_unique<HeldVelocities>(dynamics_of(*differential), nw, model->get_dt());
}

SymplecticData::~IntegratedActionDataSymplectic() = default;

// Computes the next state. d.dx is the step [h v+; h a] before the correction of momentum.
void SymplecticModel::evaluate(SymplecticData& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  if (!u) return calc_terminal(x, d);
  control_->calc(d.control, 0, *u);
  differential_->calc(d.differential, x, d.control->w);
  const DataCollector& m = dynamics_of(*d.differential);
  if (!is_of(*d.held, m, time_step_)) d.held = std::make_unique<HeldVelocities>(m, control_->get_nw(), time_step_);
  d.held->solve_at(x, time_step_, m);
  d.held->finish_step(m, time_step_, d.xnext);
  d.dx << time_step_ * d.held->x, d.held->x - d.held->v;
  d.cost = time_step_ * d.differential->cost;
  internal::copy_values(*d.differential, with_cost_residual_, d);
}

// Computes Fx and Fu: first by these formulas, then with the rotation of free joints' axes and the momentum correction.
//     Fx = I + [h^2 a_x + h [0 I]; h a_x],    Fw = [h^2 a_w; h a_w],    Fu = Fw dw/du
void SymplecticModel::differentiate(SymplecticData& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  if (!u) return calcDiff_terminal(x, d);
  const Eigen::Index nv = state_->get_nv(), ndx = state_->get_ndx(), nw = control_->get_nw();
  differential_->calcDiff(d.differential, x, d.control->w);
  const DataCollector& m = dynamics_of(*d.differential);
  d.held->differentiate_at(m, d.F.bottomRows(nv));
  d.F.topRows(nv) = time_step2_ * d.F.bottomRows(nv);
  d.F.bottomRows(nv) *= time_step_;
  d.F.block(0, nv, nv, nv).diagonal().array() += time_step_;
  d.F.diagonal().array() += 1;
  d.held->differentiate_finish(m, time_step_, d.F);
  d.Fx = d.F.leftCols(ndx);
  control_->multiplyByJacobian(d.control, d.F.rightCols(nw), d.Fu);
  internal::integrate_cost_derivatives(time_step_, *control_, d.control, *d.differential, d.Lwu, d);
  internal::copy_constraint_derivatives(*control_, d.control, *d.differential, d);
}

}  // namespace manycontact
