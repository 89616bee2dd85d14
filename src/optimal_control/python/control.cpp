#include "action.hpp"
#include "manycontact/control/euler.hpp"
#include "manycontact/control/impulse_fwddyn.hpp"
#include "manycontact/control/lqr.hpp"
#include "manycontact/control/num_diff.hpp"
#include "manycontact/control/rk.hpp"
#include "manycontact/control/symplectic.hpp"
#include "manycontact/control/unicycle.hpp"
#include "manycontact/detail/control/augmented_action.hpp"
#include "manycontact/detail/control/parts.hpp"
#include "manycontact/detail/control/state_vector.hpp"

namespace manycontact::python {

namespace {

using Node = ActionModelAbstract;
using NodeData = ActionDataAbstract;

void add_node_base(py::module_& m) {
  auto data = shared<NodeData>(m);
  auto model = shared<Node, PyActionModel<Node, NodeData>>(m);
  data.constructors<void(const Node*)>();
  add_action_data(data);
  data.views<&NodeData::xnext>();

  model.constructors<void(std::shared_ptr<StateAbstract>, std::size_t, std::size_t, std::size_t, std::size_t,
                          std::size_t, std::size_t)>();
  add_action_model<NodeData>(model);

  shared<StateVector, StateAbstract>(m).constructors<void(std::size_t)>();
}

void add_integrators(py::module_& m) {
  using Model = std::shared_ptr<DifferentialActionModelAbstract>;
  using Control = std::shared_ptr<ControlParametrizationModelAbstract>;
  enumeration<RKType, two, three, four>(m);
  shared<ControlParametrizationModelAbstract>(m)
      .read<&ControlParametrizationModelAbstract::get_nw, &ControlParametrizationModelAbstract::get_nu>();
  using P = ControlParametrizationModelAbstract;
  shared<ControlParametrizationModelPolyZero, P>(m).constructors<void(std::size_t)>();
  shared<ControlParametrizationModelPolyOne, P>(m).constructors<void(std::size_t)>();
  shared<ControlParametrizationModelPolyTwoRK, P>(m).constructors<void(std::size_t, RKType)>();

  using Integrated = IntegratedActionModelAbstract;
  shared<Integrated, Node>(m)
      .read<&Integrated::get_differential, &Integrated::get_control>()
      .property<&Integrated::get_dt, &Integrated::set_dt>();
  shared<IntegratedActionModelEuler, Integrated>(m)
      .constructors<void(Model, double, bool), void(Model, Control, double, bool)>();
  shared<IntegratedActionModelRK, Integrated>(m)
      .constructors<void(Model, RKType, double, bool), void(Model, Control, RKType, double, bool)>();

  shared<IntegratedActionModelSymplectic, Integrated>(m)
      .constructors<void(Model, double, bool), void(Model, Control, double, bool)>();

  using Differential = std::shared_ptr<DifferentialActionDataAbstract>;
  shared<IntegratedActionDataEuler, NodeData>(m).read(
      "differential", [](const IntegratedActionDataEuler& d) -> Differential { return d.differential; });
  shared<IntegratedActionDataRK, NodeData>(m).read("differential",
                                                   [](const IntegratedActionDataRK& d) { return d.differential; });
  shared<IntegratedActionDataSymplectic, NodeData>(m).read(
      "differential", [](const IntegratedActionDataSymplectic& d) -> Differential { return d.differential; });
}

void add_impulse(py::module_& m) {
  using State = std::shared_ptr<StateMultibody>;
  using Impulses = std::shared_ptr<ImpulseModelMultiple>;
  using Costs = std::shared_ptr<CostModelSum>;
  using Constraints = std::shared_ptr<ConstraintModelManager>;
  using Model = ActionModelImpulseFwdDynamics;
  shared<Model, Node>(m)
      .constructors<void(State, Impulses, Costs, double, double, bool),
                    void(State, Impulses, Costs, Constraints, double, double, bool)>()
      .read<&Model::get_impulses, &Model::get_costs, &Model::get_constraints>()
      .property("r_coeff", &Model::get_restitution_coefficient, &Model::set_restitution_coefficient);
  using Data = ActionDataImpulseFwdDynamics;
  shared<Data, NodeData>(m).read(
      "report", [](const Data& d) { return d.report(); }, "impulses",
      [](const Data& d) { return d.multibody->contacts->contacts; });
}

void add_examples(py::module_& m) {
  using Lqr = ActionModelLQR;
  shared<Lqr, Node>(m)
      .constructors<void(const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&),
                    void(const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Vector&,
                         const Vector&, const Vector&),
                    void(std::size_t, std::size_t, bool)>()
      .read<&Lqr::get_A, &Lqr::get_B, &Lqr::get_Q, &Lqr::get_R>();
  using Unicycle = ActionModelUnicycle;
  shared<Unicycle, Node>(m)
      .constructors<void()>()
      .property("costWeights", &Unicycle::get_cost_weights, &Unicycle::set_cost_weights)
      .property<&Unicycle::get_dt, &Unicycle::set_dt>();
  using NumDiff = ActionModelNumDiff;
  shared<NumDiff, Node>(m)
      .constructors<void(std::shared_ptr<Node>, bool)>()
      .read<&NumDiff::get_model>()
      .property<&NumDiff::get_disturbance, &NumDiff::set_disturbance>();
  // These classes of nodes cannot be created in Python. They have the members of the base class.
  shared<ActionModelParts, Node>(m);
  shared<ActionModelAugmentedLagrangian, Node>(m).read<&ActionModelAugmentedLagrangian::get_model>();
}

}  // namespace

void add_control(py::module_& m) {
  add_node_base(m);
  add_integrators(m);
  add_impulse(m);
  add_examples(m);
}

}  // namespace manycontact::python
