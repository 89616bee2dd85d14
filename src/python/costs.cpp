// Cones, costs and constraints: floor action.

#include "action.hpp"
#include "manycontact/action/cones.hpp"
#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;
using State = std::shared_ptr<StateMultibody>;

using Matrix = Eigen::MatrixXd;

// What all cones have. Setters take effect at once.
template <class Cone, class Class>
Class& add_cone(Class& c) {
  return add_copy(c)
      .def("update", &Cone::update, "Crocoddyl's; setters have done it.")
      .def_property_readonly("A", [](const Cone& x) { return Matrix(x.get_A()); })
      .def_property_readonly("lb", [](const Cone& x) { return Vector(x.get_lb()); })
      .def_property_readonly("ub", [](const Cone& x) { return Vector(x.get_ub()); })
      .def_property(
          "R", &Cone::get_R, [](Cone& x, const Eigen::Matrix3d& R) { x.set_R(R), x.update(); },
          "The cone's axes in the axes of the force (3, 3).")
      .def("__str__", &text_of<Cone>);
}

template <class Cone, class Class>
Class& add_friction(Class& c) {
  return c.def_property_readonly("nf", &Cone::get_nf, "Facets.")
      .def_property("mu", &Cone::get_mu, [](Cone& x, double mu) { x.set_mu(mu), x.update(); })
      .def_property("inner_appr", &Cone::get_inner_appr,
                    [](Cone& x, bool inner) { x.set_inner_appr(inner), x.update(); })
      .def_property(
          "min_nforce", &Cone::get_min_nforce, [](Cone& x, double f) { x.set_min_nforce(f), x.update(); }, "[N]")
      .def_property(
          "max_nforce", &Cone::get_max_nforce, [](Cone& x, double f) { x.set_max_nforce(f), x.update(); }, "[N]");
}

template <class Cone, class Class>
Class& add_box(Class& c) {
  return c.def_property(
      "box", &Cone::get_box, [](Cone& x, const Eigen::Vector2d& box) { x.set_box(box), x.update(); },
      "Length and width (2) [m].");
}

// For pickle: the class, and what to make it of.
template <class Cone, class... Arguments>
py::tuple by_constructor(Arguments&&... arguments) {
  return py::make_tuple(py::type::of<Cone>(), py::make_tuple(std::forward<Arguments>(arguments)...));
}

void add_cones(py::module_& m) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const auto infinite = py::arg_v("max_nforce", std::numeric_limits<double>::infinity(), "float('inf')");
  py::class_<FrictionCone> friction(m, "FrictionCone",
                                    "lb <= A f <= ub on a force (3): nf facets and the normal force.");
  friction.def(py::init<const Eigen::Matrix3d&, double, std::size_t, bool, double, double>(),
               py::arg_v("R", I, "numpy.eye(3)"), py::arg("mu") = 0.7, py::arg("nf") = 4, py::arg("inner_appr") = true,
               py::arg("min_nforce") = 0.0, infinite,
               "R: the cone's axes in the axes of f, z the normal. Forces in N.");
  add_friction<FrictionCone>(add_cone<FrictionCone>(friction)).def("__reduce__", [](const FrictionCone& x) {
    return by_constructor<FrictionCone>(copy(x.get_R()), x.get_mu(), x.get_nf(), x.get_inner_appr(), x.get_min_nforce(),
                                        x.get_max_nforce());
  });

  py::class_<WrenchCone> wrench(m, "WrenchCone",
                                "lb <= A w <= ub on a wrench (6) of a rectangular foot: nf + 13 rows.");
  wrench.def(py::init<const Eigen::Matrix3d&, double, const Eigen::Vector2d&, std::size_t, bool, double, double>(),
             py::arg("R"), py::arg("mu"), py::arg("box"), py::arg("nf") = 4, py::arg("inner_appr") = true,
             py::arg("min_nforce") = 0.0, infinite, "box: length and width [m].");
  add_box<WrenchCone>(add_friction<WrenchCone>(add_cone<WrenchCone>(wrench)));
  wrench.def("__reduce__", [](const WrenchCone& x) {
    return by_constructor<WrenchCone>(copy(x.get_R()), x.get_mu(), copy(x.get_box()), x.get_nf(), x.get_inner_appr(),
                                      x.get_min_nforce(), x.get_max_nforce());
  });

  py::class_<CoPSupport> support(m, "CoPSupport",
                                 "lb <= A w <= ub on a wrench (6): centre of pressure inside the box.");
  support.def(py::init<const Eigen::Matrix3d&, const Eigen::Vector2d&>(), py::arg("R"), py::arg("box"));
  add_box<CoPSupport>(add_cone<CoPSupport>(support)).def("__reduce__", [](const CoPSupport& x) {
    return by_constructor<CoPSupport>(copy(x.get_R()), copy(x.get_box()));
  });
}

void add_cost_models(py::module_& m) {
  using Activation = std::shared_ptr<ActivationModelAbstract>;
  using Residual = std::shared_ptr<ResidualModelAbstract>;
  py::class_<CostDataResidual, std::shared_ptr<CostDataResidual>>(m, "CostDataResidual", "One cost's own numbers.")
      .def_readonly("cost", &CostDataResidual::cost)
      .def_readonly("activation", &CostDataResidual::activation)
      .def_readonly("residual", &CostDataResidual::residual)
      .def_property_readonly(
          "Lx", [](const CostDataResidual& d) { return d.whole_derivatives().Lx; }, "(ndx), without the weight.")
      .def_property_readonly(
          "Lu", [](const CostDataResidual& d) { return d.whole_derivatives().Lu; }, "(nu)")
      .def_property_readonly(
          "Lxx", [](const CostDataResidual& d) { return d.whole_derivatives().Lxx; }, "(ndx, ndx), Gauss-Newton.")
      .def_property_readonly(
          "Lxu", [](const CostDataResidual& d) { return d.whole_derivatives().Lxu; }, "(ndx, nu)")
      .def_property_readonly(
          "Luu", [](const CostDataResidual& d) { return d.whole_derivatives().Luu; }, "(nu, nu)");
  py::class_<CostModelResidual, std::shared_ptr<CostModelResidual>>(
      m, "CostModelResidual", "The cost a(r(x, u)); without an activation 1/2 |r|^2.")
      .def(py::init<State, Activation, Residual>(), py::arg("state"), py::arg("activation").none(false),
           py::arg("residual").none(false))
      .def(py::init<State, Residual>(), py::arg("state"), py::arg("residual").none(false))
      .def_property_readonly("state", &CostModelResidual::get_state)
      .def_property_readonly("activation", &CostModelResidual::get_activation)
      .def_property_readonly("residual", &CostModelResidual::get_residual)
      .def_property_readonly("nu", &CostModelResidual::get_nu)
      .def("__str__", &text_of<CostModelResidual>);
  py::class_<CostItem, std::shared_ptr<CostItem>>(m, "CostItem")
      .def_readonly("name", &CostItem::name)
      .def_readonly("cost", &CostItem::cost)
      .def_readwrite("weight", &CostItem::weight)
      .def_readonly("active", &CostItem::active);
  using Sum = CostModelSum;
  py::class_<Sum, std::shared_ptr<Sum>>(m, "CostModelSum", "Costs by name, summed with weights.")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"))
      .def("addCost", &Sum::addCost, py::arg("name"), py::arg("cost").none(false), py::arg("weight"),
           py::arg("active") = true)
      .def("removeCost", &Sum::removeCost, py::arg("name"))
      .def("changeCostStatus", &Sum::changeCostStatus, py::arg("name"), py::arg("active"))
      .def("getCostStatus", &Sum::getCostStatus, py::arg("name"))
      .def_property_readonly("state", &Sum::get_state)
      .def_property_readonly("costs", &Sum::get_costs, "{name: CostItem}")
      .def_property_readonly("nu", &Sum::get_nu)
      .def_property_readonly("nr", &Sum::get_nr)
      .def_property_readonly("active_set", &Sum::get_active_set)
      .def_property_readonly("inactive_set", &Sum::get_inactive_set)
      .def("__str__", &text_of<Sum>);
  m.attr("CostModelAbstract") = m.attr("CostModelResidual");
}

void add_constraints(py::module_& m) {
  using Residual = std::shared_ptr<ResidualModelAbstract>;
  using One = ConstraintModelResidual;
  py::class_<One, std::shared_ptr<One>>(
      m, "ConstraintModelResidual", "lower <= r(x, u) <= upper; equality where the bounds are equal, r = 0 without.")
      .def(py::init([](State state, Residual residual, const Bounds& lower, const Bounds& upper, bool T_act) {
             return std::make_shared<One>(std::move(state), std::move(residual), lower.x, upper.x, T_act);
           }),
           py::arg("state"), py::arg("residual").none(false), py::arg("lower"), py::arg("upper"),
           py::arg("T_act") = true)
      .def(py::init<State, Residual, bool>(), py::arg("state"), py::arg("residual").none(false),
           py::arg("T_act") = true)
      .def_property_readonly("residual", &One::get_residual)
      .def_property_readonly("ng", &One::get_ng)
      .def_property_readonly("nh", &One::get_nh)
      .def_property_readonly("lb", &One::get_lb, "(nr)")
      .def_property_readonly("ub", &One::get_ub, "(nr)")
      .def("__str__", &text_of<One>);
  using Manager = ConstraintModelManager;
  py::class_<Manager, std::shared_ptr<Manager>>(m, "ConstraintModelManager", "Constraints by name.")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"))
      .def("addConstraint", &Manager::addConstraint, py::arg("name"), py::arg("constraint").none(false),
           py::arg("active") = true)
      .def("removeConstraint", &Manager::removeConstraint, py::arg("name"))
      .def("changeConstraintStatus", &Manager::changeConstraintStatus, py::arg("name"), py::arg("active"))
      .def("getConstraintStatus", &Manager::getConstraintStatus, py::arg("name"))
      .def_property_readonly("ng", &Manager::get_ng)
      .def_property_readonly("nh", &Manager::get_nh)
      .def_property_readonly("ng_T", &Manager::get_ng_T)
      .def_property_readonly("nh_T", &Manager::get_nh_T)
      .def_property_readonly("lb", &Manager::get_lb, "(ng)")
      .def_property_readonly("ub", &Manager::get_ub, "(ng)")
      .def_property_readonly("active_set", &Manager::get_active_set)
      .def_property_readonly("inactive_set", &Manager::get_inactive_set)
      .def("__str__", &text_of<Manager>);
}

}  // namespace

void add_costs(py::module_& m) {
  add_cones(m);
  add_cost_models(m);
  add_constraints(m);
}

}  // namespace manycontact::python
