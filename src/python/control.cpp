// Nodes of optimal control problems: floor control.

#include "action.hpp"
#include "manycontact/control/augmented_action.hpp"
#include "manycontact/control/euler.hpp"
#include "manycontact/control/impulse_fwddyn.hpp"
#include "manycontact/control/lqr.hpp"
#include "manycontact/control/num_diff.hpp"
#include "manycontact/control/parts.hpp"
#include "manycontact/control/rk.hpp"
#include "manycontact/control/state_vector.hpp"
#include "manycontact/control/symplectic.hpp"
#include "manycontact/control/unicycle.hpp"

namespace manycontact::python {

namespace {

using Node = ActionModelAbstract;
using NodeData = ActionDataAbstract;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

void add_node_base(py::module_& m) {
  py::class_<NodeData, std::shared_ptr<NodeData>> data(m, "ActionDataAbstract");
  py::class_<Node, PyActionModel<Node, NodeData>, std::shared_ptr<Node>> model(
      m, "ActionModelAbstract",
      "A node in discrete time. Derive from it: calc(self, data, x, u=None) sets data.xnext and data.cost;\n"
      "calcDiff(self, data, x, u=None) sets data.Fx, Fu, Lx, Lu, Lxx, Lxu, Luu; without u the node is terminal.\n"
      "createData(self) may return data of a class derived from ActionDataAbstract.");
  data.def(py::init<const Node*>(), py::arg("model").none(false));
  add_action_data(data);
  member_view(data, "xnext", &NodeData::xnext, "Next state (nx): by calc.");

  model.def(py::init<std::shared_ptr<StateAbstract>, std::size_t, std::size_t, std::size_t, std::size_t, std::size_t,
                     std::size_t>(),
            py::arg("state"), py::arg("nu"), py::arg("nr") = 0, py::arg("ng") = 0, py::arg("nh") = 0,
            py::arg("ng_T") = 0, py::arg("nh_T") = 0);
  add_action_model<NodeData>(model);

  py::class_<StateVector, StateAbstract, std::shared_ptr<StateVector>>(m, "StateVector", "x (+) dx = x + dx.")
      .def(py::init<std::size_t>(), py::arg("nx"));
}

template <class T>
auto action(py::module_& m, const char* name, const char* doc) {
  return py::class_<T, Node, std::shared_ptr<T>>(m, name, doc);
}

void add_integrators(py::module_& m) {
  using Model = std::shared_ptr<DifferentialActionModelAbstract>;
  using Control = std::shared_ptr<ControlParametrizationModelAbstract>;
  add_enumeration<RKType>(m, "RKType", "number of stages", "Stages of a Runge-Kutta scheme.",
                          {{"two", two}, {"three", three}, {"four", four}});
  py::class_<ControlParametrizationModelAbstract, Control>(m, "ControlParametrizationModelAbstract",
                                                           "Controls within a step, as polynomials.")
      .def_property_readonly("nw", &ControlParametrizationModelAbstract::get_nw)
      .def_property_readonly("nu", &ControlParametrizationModelAbstract::get_nu);
  const auto parametrization = [&]<class T>(const char* name, const char* doc, T*) {
    return py::class_<T, ControlParametrizationModelAbstract, std::shared_ptr<T>>(m, name, doc);
  };
  parametrization("ControlParametrizationModelPolyZero", "Constant.", (ControlParametrizationModelPolyZero*)nullptr)
      .def(py::init<std::size_t>(), py::arg("nw"));
  parametrization("ControlParametrizationModelPolyOne", "Linear.", (ControlParametrizationModelPolyOne*)nullptr)
      .def(py::init<std::size_t>(), py::arg("nw"));
  parametrization("ControlParametrizationModelPolyTwoRK", "Quadratic.", (ControlParametrizationModelPolyTwoRK*)nullptr)
      .def(py::init<std::size_t, RKType>(), py::arg("nw"), py::arg("rktype"));

  using Integrated = IntegratedActionModelAbstract;
  action<Integrated>(m, "IntegratedActionModelAbstract", "A differential action model over one step.")
      .def_property_readonly("differential", &Integrated::get_differential)
      .def_property_readonly("control", &Integrated::get_control)
      .def_property("dt", &Integrated::get_dt, &Integrated::set_dt, "[s]");
  py::class_<IntegratedActionModelEuler, Integrated, std::shared_ptr<IntegratedActionModelEuler>>(
      m, "IntegratedActionModelEuler", "Symplectic Euler: x' = x (+) [h v + h^2 a; h a].")
      .def(py::init<Model, double, bool>(), py::arg("model").none(false), py::arg("timeStep") = 1e-3,
           py::arg("withCostResidual") = true)
      .def(py::init<Model, Control, double, bool>(), py::arg("model").none(false), py::arg("control").none(false),
           py::arg("timeStep") = 1e-3, py::arg("withCostResidual") = true);
  py::class_<IntegratedActionModelRK, Integrated, std::shared_ptr<IntegratedActionModelRK>>(
      m, "IntegratedActionModelRK", "Explicit Runge-Kutta of two, three or four stages.")
      .def(py::init<Model, RKType, double, bool>(), py::arg("model").none(false), py::arg("rktype"),
           py::arg("timeStep") = 1e-3, py::arg("withCostResidual") = true)
      .def(py::init<Model, Control, RKType, double, bool>(), py::arg("model").none(false),
           py::arg("control").none(false), py::arg("rktype"), py::arg("timeStep") = 1e-3,
           py::arg("withCostResidual") = true);

  py::class_<IntegratedActionModelSymplectic, Integrated, std::shared_ptr<IntegratedActionModelSymplectic>>(
      m, "IntegratedActionModelSymplectic",
      "The step of SimulationData by 'semi-implicit-euler': contacts held in the velocity, momentum kept.")
      .def(py::init<Model, double, bool>(), py::arg("model").none(false), py::arg("timeStep") = 1e-3,
           py::arg("withCostResidual") = true)
      .def(py::init<Model, Control, double, bool>(), py::arg("model").none(false), py::arg("control").none(false),
           py::arg("timeStep") = 1e-3, py::arg("withCostResidual") = true);

  using Differential = std::shared_ptr<DifferentialActionDataAbstract>;
  py::class_<IntegratedActionDataEuler, NodeData, std::shared_ptr<IntegratedActionDataEuler>>(
      m, "IntegratedActionDataEuler")
      .def_property_readonly("differential",
                             [](const IntegratedActionDataEuler& d) -> Differential { return d.differential; });
  py::class_<IntegratedActionDataRK, NodeData, std::shared_ptr<IntegratedActionDataRK>>(m, "IntegratedActionDataRK")
      .def_property_readonly(
          "differential", [](const IntegratedActionDataRK& d) { return d.differential; }, "Of each stage.");
  py::class_<IntegratedActionDataSymplectic, NodeData, std::shared_ptr<IntegratedActionDataSymplectic>>(
      m, "IntegratedActionDataSymplectic")
      .def_property_readonly("differential",
                             [](const IntegratedActionDataSymplectic& d) -> Differential { return d.differential; });
}

void add_impulse(py::module_& m) {
  using State = std::shared_ptr<StateMultibody>;
  using Impulses = std::shared_ptr<ImpulseModelMultiple>;
  using Costs = std::shared_ptr<CostModelSum>;
  using Constraints = std::shared_ptr<ConstraintModelManager>;
  using Model = ActionModelImpulseFwdDynamics;
  action<Model>(m, "ActionModelImpulseFwdDynamics", "An impact: the velocity jumps, the configuration stays.")
      .def(py::init<State, Impulses, Costs, double, double, bool>(), py::arg("state"), py::arg("impulses"),
           py::arg("costs"), py::arg("r_coeff") = 0.0, py::arg("JMinvJt_damping") = 0.0,
           py::arg("enable_force") = false)
      .def(py::init<State, Impulses, Costs, Constraints, double, double, bool>(), py::arg("state"), py::arg("impulses"),
           py::arg("costs"), py::arg("constraints"), py::arg("r_coeff") = 0.0, py::arg("JMinvJt_damping") = 0.0,
           py::arg("enable_force") = false)
      .def_property_readonly("impulses", &Model::get_impulses)
      .def_property_readonly("costs", &Model::get_costs)
      .def_property_readonly("constraints", &Model::get_constraints)
      .def_property("r_coeff", &Model::get_restitution_coefficient, &Model::set_restitution_coefficient);
  using Data = ActionDataImpulseFwdDynamics;
  py::class_<Data, NodeData, std::shared_ptr<Data>>(m, "ActionDataImpulseFwdDynamics")
      .def_property_readonly(
          "report", [](const Data& d) { return d.report(); }, "Report of the last calc; a copy.")
      .def_property_readonly(
          "impulses", [](const Data& d) { return d.multibody->contacts->contacts; },
          "{name: ContactDataAbstract}, f in N s, N m s.");
}

void add_examples(py::module_& m) {
  using Lqr = ActionModelLQR;
  action<Lqr>(m, "ActionModelLQR", "x' = A x + B u + f, l = 1/2 x'Q x + 1/2 u'R u + x'N u + q'x + r'u.")
      .def(py::init<const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&>(), py::arg("A"),
           py::arg("B"), py::arg("Q"), py::arg("R"), py::arg("N"))
      .def(py::init<const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Vector&,
                    const Vector&, const Vector&>(),
           py::arg("A"), py::arg("B"), py::arg("Q"), py::arg("R"), py::arg("N"), py::arg("f"), py::arg("q"),
           py::arg("r"))
      .def(py::init<std::size_t, std::size_t, bool>(), py::arg("nx"), py::arg("nu"), py::arg("drift_free") = true)
      .def_property_readonly("A", &Lqr::get_A)
      .def_property_readonly("B", &Lqr::get_B)
      .def_property_readonly("Q", &Lqr::get_Q)
      .def_property_readonly("R", &Lqr::get_R);
  using Unicycle = ActionModelUnicycle;
  action<Unicycle>(m, "ActionModelUnicycle", "A wheel in the plane: x = [x; y; theta], u = [v; omega].")
      .def(py::init<>())
      .def_property("costWeights", &Unicycle::get_cost_weights, &Unicycle::set_cost_weights, "wx, wu")
      .def_property("dt", &Unicycle::get_dt, &Unicycle::set_dt, "[s]");
  using NumDiff = ActionModelNumDiff;
  action<NumDiff>(m, "ActionModelNumDiff", "A model with derivatives by central differences.")
      .def(py::init<std::shared_ptr<Node>, bool>(), py::arg("model").none(false), py::arg("with_gauss_approx") = false)
      .def_property_readonly("model", &NumDiff::get_model)
      .def_property("disturbance", &NumDiff::get_disturbance, &NumDiff::set_disturbance);
  // Nodes of the library's own making, with what all have.
  action<ActionModelParts>(m, "ActionModelParts", "A node of robots that never meet; tasks make them.");
  action<ActionModelAugmentedLagrangian>(m, "ActionModelAugmentedLagrangian", "A node within an augmented Lagrangian.")
      .def_property_readonly("model", &ActionModelAugmentedLagrangian::get_model);
}

}  // namespace

void add_control(py::module_& m) {
  add_node_base(m);
  add_integrators(m);
  add_impulse(m);
  add_examples(m);
}

}  // namespace manycontact::python
