// Nodes of optimal control problems.

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
  py::class_<NodeData, std::shared_ptr<NodeData>> data(m, "ActionDataAbstract",
                                                       "The results of a node in discrete time.");
  py::class_<Node, PyActionModel<Node, NodeData>, std::shared_ptr<Node>> model(
      m, "ActionModelAbstract",
      "A node in discrete time.\n"
      "\n"
      "In a derived class calc(self, data, x, u=None) sets data.xnext and data.cost, and calcDiff(self, data, x,\n"
      "u=None)\n"
      "sets data.Fx, Fu, Lx, Lu, Lxx, Lxu and Luu. Without u the node is terminal. createData(self) may return\n"
      "data of a\n"
      "class derived from ActionDataAbstract.");
  data.def(py::init<const Node*>(), py::arg("model").none(false));
  add_action_data(data);
  member_view(data, "xnext", &NodeData::xnext, "Next state (nx); set by calc.");

  model.def(py::init<std::shared_ptr<StateAbstract>, std::size_t, std::size_t, std::size_t, std::size_t, std::size_t,
                     std::size_t>(),
            py::arg("state"), py::arg("nu"), py::arg("nr") = 0, py::arg("ng") = 0, py::arg("nh") = 0,
            py::arg("ng_T") = 0, py::arg("nh_T") = 0);
  add_action_model<NodeData>(model);

  py::class_<StateVector, StateAbstract, std::shared_ptr<StateVector>>(m, "StateVector",
                                                                       "A vector space: x (+) dx = x + dx.")
      .def(py::init<std::size_t>(), py::arg("nx"));
}

template <class T>
auto action(py::module_& m, const char* name, const char* doc) {
  return py::class_<T, Node, std::shared_ptr<T>>(m, name, doc);
}

void add_integrators(py::module_& m) {
  using Model = std::shared_ptr<DifferentialActionModelAbstract>;
  using Control = std::shared_ptr<ControlParametrizationModelAbstract>;
  add_enumeration<RKType>(m, "RKType", "number of stages", "The number of stages of a Runge-Kutta method.",
                          {{"two", two}, {"three", three}, {"four", four}});
  py::class_<ControlParametrizationModelAbstract, Control>(
      m, "ControlParametrizationModelAbstract", "Controls within a step, as polynomials of their parameters.")
      .def_property_readonly("nw", &ControlParametrizationModelAbstract::get_nw, "Number of controls w at one time.")
      .def_property_readonly("nu", &ControlParametrizationModelAbstract::get_nu, "Number of parameters u.");
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
  action<Integrated>(m, "IntegratedActionModelAbstract", "A differential action model integrated over one step.")
      .def_property_readonly("differential", &Integrated::get_differential,
                             "Model or data of the node in continuous time.")
      .def_property_readonly("control", &Integrated::get_control, "Parametrization of the controls.")
      .def_property("dt", &Integrated::get_dt, &Integrated::set_dt, "[s]");
  py::class_<IntegratedActionModelEuler, Integrated, std::shared_ptr<IntegratedActionModelEuler>>(
      m, "IntegratedActionModelEuler", "A step of symplectic Euler: x' = x (+) [h v + h^2 a; h a].")
      .def(py::init<Model, double, bool>(), py::arg("model").none(false), py::arg("timeStep") = 1e-3,
           py::arg("withCostResidual") = true)
      .def(py::init<Model, Control, double, bool>(), py::arg("model").none(false), py::arg("control").none(false),
           py::arg("timeStep") = 1e-3, py::arg("withCostResidual") = true);
  py::class_<IntegratedActionModelRK, Integrated, std::shared_ptr<IntegratedActionModelRK>>(
      m, "IntegratedActionModelRK", "A step of an explicit Runge-Kutta method with two, three or four stages.")
      .def(py::init<Model, RKType, double, bool>(), py::arg("model").none(false), py::arg("rktype"),
           py::arg("timeStep") = 1e-3, py::arg("withCostResidual") = true)
      .def(py::init<Model, Control, RKType, double, bool>(), py::arg("model").none(false),
           py::arg("control").none(false), py::arg("rktype"), py::arg("timeStep") = 1e-3,
           py::arg("withCostResidual") = true);

  py::class_<IntegratedActionModelSymplectic, Integrated, std::shared_ptr<IntegratedActionModelSymplectic>>(
      m, "IntegratedActionModelSymplectic",
      "A step of semi-implicit Euler, as in simulations: contacts constrain the velocity, and momentum is\n"
      "conserved.")
      .def(py::init<Model, double, bool>(), py::arg("model").none(false), py::arg("timeStep") = 1e-3,
           py::arg("withCostResidual") = true)
      .def(py::init<Model, Control, double, bool>(), py::arg("model").none(false), py::arg("control").none(false),
           py::arg("timeStep") = 1e-3, py::arg("withCostResidual") = true);

  using Differential = std::shared_ptr<DifferentialActionDataAbstract>;
  py::class_<IntegratedActionDataEuler, NodeData, std::shared_ptr<IntegratedActionDataEuler>>(
      m, "IntegratedActionDataEuler", "Data of IntegratedActionModelEuler.")
      .def_property_readonly(
          "differential", [](const IntegratedActionDataEuler& d) -> Differential { return d.differential; },
          "Model or data of the node in continuous time.");
  py::class_<IntegratedActionDataRK, NodeData, std::shared_ptr<IntegratedActionDataRK>>(
      m, "IntegratedActionDataRK", "Data of IntegratedActionModelRK.")
      .def_property_readonly(
          "differential", [](const IntegratedActionDataRK& d) { return d.differential; },
          "Data of the node in continuous time at each stage.");
  py::class_<IntegratedActionDataSymplectic, NodeData, std::shared_ptr<IntegratedActionDataSymplectic>>(
      m, "IntegratedActionDataSymplectic", "Data of IntegratedActionModelSymplectic.")
      .def_property_readonly(
          "differential", [](const IntegratedActionDataSymplectic& d) -> Differential { return d.differential; },
          "Model or data of the node in continuous time.");
}

void add_impulse(py::module_& m) {
  using State = std::shared_ptr<StateMultibody>;
  using Impulses = std::shared_ptr<ImpulseModelMultiple>;
  using Costs = std::shared_ptr<CostModelSum>;
  using Constraints = std::shared_ptr<ConstraintModelManager>;
  using Model = ActionModelImpulseFwdDynamics;
  action<Model>(m, "ActionModelImpulseFwdDynamics", "An impact: the velocity jumps, the configuration does not change.")
      .def(py::init<State, Impulses, Costs, double, double, bool>(), py::arg("state"), py::arg("impulses"),
           py::arg("costs"), py::arg("r_coeff") = 0.0, py::arg("JMinvJt_damping") = 0.0,
           py::arg("enable_force") = false)
      .def(py::init<State, Impulses, Costs, Constraints, double, double, bool>(), py::arg("state"), py::arg("impulses"),
           py::arg("costs"), py::arg("constraints"), py::arg("r_coeff") = 0.0, py::arg("JMinvJt_damping") = 0.0,
           py::arg("enable_force") = false)
      .def_property_readonly("impulses", &Model::get_impulses, "ImpulseModelMultiple.")
      .def_property_readonly("costs", &Model::get_costs, "CostModelSum.")
      .def_property_readonly("constraints", &Model::get_constraints, "ConstraintModelManager, or None.")
      .def_property("r_coeff", &Model::get_restitution_coefficient, &Model::set_restitution_coefficient,
                    "Coefficient of restitution, not negative.");
  using Data = ActionDataImpulseFwdDynamics;
  py::class_<Data, NodeData, std::shared_ptr<Data>>(m, "ActionDataImpulseFwdDynamics",
                                                    "Data of ActionModelImpulseFwdDynamics.")
      .def_property_readonly(
          "report", [](const Data& d) { return d.report(); }, "Report of the last calc; a copy.")
      .def_property_readonly(
          "impulses", [](const Data& d) { return d.multibody->contacts->contacts; },
          "{name: ContactDataAbstract}, with f in N s, N m s.");
}

void add_examples(py::module_& m) {
  using Lqr = ActionModelLQR;
  action<Lqr>(m, "ActionModelLQR",
              "Linear dynamics x' = A x + B u + f with the cost 1/2 x'Q x + 1/2 u'R u + x'N u + q'x + r'u.")
      .def(py::init<const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&>(), py::arg("A"),
           py::arg("B"), py::arg("Q"), py::arg("R"), py::arg("N"))
      .def(py::init<const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Vector&,
                    const Vector&, const Vector&>(),
           py::arg("A"), py::arg("B"), py::arg("Q"), py::arg("R"), py::arg("N"), py::arg("f"), py::arg("q"),
           py::arg("r"))
      .def(py::init<std::size_t, std::size_t, bool>(), py::arg("nx"), py::arg("nu"), py::arg("drift_free") = true)
      .def_property_readonly("A", &Lqr::get_A, "Matrix of x in the dynamics (nx, nx).")
      .def_property_readonly("B", &Lqr::get_B, "Matrix of u in the dynamics (nx, nu).")
      .def_property_readonly("Q", &Lqr::get_Q, "Hessian of the cost with respect to x (nx, nx).")
      .def_property_readonly("R", &Lqr::get_R, "Hessian of the cost with respect to u (nu, nu).");
  using Unicycle = ActionModelUnicycle;
  action<Unicycle>(m, "ActionModelUnicycle", "A wheel in the plane: x = [x; y; theta], u = [v; omega].")
      .def(py::init<>())
      .def_property("costWeights", &Unicycle::get_cost_weights, &Unicycle::set_cost_weights, "Weights wx and wu (2).")
      .def_property("dt", &Unicycle::get_dt, &Unicycle::set_dt, "Time step [s].");
  using NumDiff = ActionModelNumDiff;
  action<NumDiff>(m, "ActionModelNumDiff", "A model with derivatives by central differences.")
      .def(py::init<std::shared_ptr<Node>, bool>(), py::arg("model").none(false), py::arg("with_gauss_approx") = false)
      .def_property_readonly("model", &NumDiff::get_model, "The model that is differentiated.")
      .def_property("disturbance", &NumDiff::get_disturbance, &NumDiff::set_disturbance, "Step of the differences.");
  // Nodes of the library's own making, with what all have.
  action<ActionModelParts>(m, "ActionModelParts", "A node made of decoupled subproblems; tasks make such nodes.");
  action<ActionModelAugmentedLagrangian>(m, "ActionModelAugmentedLagrangian",
                                         "A node whose constraints are part of its cost.")
      .def_property_readonly("model", &ActionModelAugmentedLagrangian::get_model, "The node with constraints.");
}

}  // namespace

void add_control(py::module_& m) {
  add_node_base(m);
  add_integrators(m);
  add_impulse(m);
  add_examples(m);
}

}  // namespace manycontact::python
