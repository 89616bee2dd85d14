// Cones, costs and constraints.

#include "action.hpp"
#include "manycontact/action/cones.hpp"
#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"
#include "shared.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;
using State = std::shared_ptr<StateMultibody>;

using Matrix = Eigen::MatrixXd;

// Members that all cones have. Setters take effect at once.
template <class Cone, class Class>
Class& add_cone(Class& c) {
  return add_copy(c)
      .def("update", &Cone::update, "Do nothing: setters update the cone. The method exists for Crocoddyl's API.")
      .def_property_readonly(
          "A", [](const Cone& x) { return Matrix(x.get_A()); }, "Matrix of the inequalities lb <= A f <= ub.")
      .def_property_readonly(
          "lb", [](const Cone& x) { return Vector(x.get_lb()); }, "Lower bounds.")
      .def_property_readonly(
          "ub", [](const Cone& x) { return Vector(x.get_ub()); }, "Upper bounds.")
      .def_property(
          "R", &Cone::get_R, [](Cone& x, const Eigen::Matrix3d& R) { x.set_R(R), x.update(); },
          "The cone's axes in the axes of the force (3, 3).")
      .def("__str__", &text_of<Cone>);
}

template <class Cone, class Class>
Class& add_friction(Class& c) {
  return c.def_property_readonly("nf", &Cone::get_nf, "Number of facets.")
      .def_property(
          "mu", &Cone::get_mu, [](Cone& x, double mu) { x.set_mu(mu), x.update(); }, "Coefficient of friction.")
      .def_property(
          "inner_appr", &Cone::get_inner_appr, [](Cone& x, bool inner) { x.set_inner_appr(inner), x.update(); },
          "Whether the facets are inside the round cone.")
      .def_property(
          "min_nforce", &Cone::get_min_nforce, [](Cone& x, double f) { x.set_min_nforce(f), x.update(); },
          "Smallest normal force [N].")
      .def_property(
          "max_nforce", &Cone::get_max_nforce, [](Cone& x, double f) { x.set_max_nforce(f), x.update(); },
          "Largest normal force [N].");
}

template <class Cone, class Class>
Class& add_box(Class& c) {
  return c.def_property(
      "box", &Cone::get_box, [](Cone& x, const Eigen::Vector2d& box) { x.set_box(box), x.update(); },
      "Length and width (2) [m].");
}

// The pickled form: the class and the arguments of its constructor.
template <class Cone, class... Arguments>
py::tuple by_constructor(Arguments&&... arguments) {
  return py::make_tuple(py::type::of<Cone>(), py::make_tuple(std::forward<Arguments>(arguments)...));
}

void add_cones(py::module_& m) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const auto infinite = py::arg_v("max_nforce", std::numeric_limits<double>::infinity(), "float('inf')");
  py::class_<FrictionCone> friction(m, "FrictionCone",
                                    "Inequalities lb <= A f <= ub of a force (3): nf facets and the normal force.");
  friction.def(py::init<const Eigen::Matrix3d&, double, std::size_t, bool, double, double>(),
               py::arg_v("R", I, "numpy.eye(3)"), py::arg("mu") = 0.7, py::arg("nf") = 4, py::arg("inner_appr") = true,
               py::arg("min_nforce") = 0.0, infinite,
               "R contains the cone's axes in the axes of f, with z the normal; forces are in N.");
  add_friction<FrictionCone>(add_cone<FrictionCone>(friction)).def("__reduce__", [](const FrictionCone& x) {
    return by_constructor<FrictionCone>(copy(x.get_R()), x.get_mu(), x.get_nf(), x.get_inner_appr(), x.get_min_nforce(),
                                        x.get_max_nforce());
  });

  py::class_<WrenchCone> wrench(m, "WrenchCone",
                                "Inequalities lb <= A w <= ub of a wrench (6) of a rectangular foot: nf + 13 rows.");
  wrench.def(py::init<const Eigen::Matrix3d&, double, const Eigen::Vector2d&, std::size_t, bool, double, double>(),
             py::arg("R"), py::arg("mu"), py::arg("box"), py::arg("nf") = 4, py::arg("inner_appr") = true,
             py::arg("min_nforce") = 0.0, infinite, "box contains length and width [m].");
  add_box<WrenchCone>(add_friction<WrenchCone>(add_cone<WrenchCone>(wrench)));
  wrench.def("__reduce__", [](const WrenchCone& x) {
    return by_constructor<WrenchCone>(copy(x.get_R()), x.get_mu(), copy(x.get_box()), x.get_nf(), x.get_inner_appr(),
                                      x.get_min_nforce(), x.get_max_nforce());
  });

  py::class_<CoPSupport> support(
      m, "CoPSupport", "Inequalities lb <= A w <= ub of a wrench (6): the centre of pressure is inside the box.");
  support.def(py::init<const Eigen::Matrix3d&, const Eigen::Vector2d&>(), py::arg("R"), py::arg("box"));
  add_box<CoPSupport>(add_cone<CoPSupport>(support)).def("__reduce__", [](const CoPSupport& x) {
    return by_constructor<CoPSupport>(copy(x.get_R()), copy(x.get_box()));
  });
}

using CostData = std::shared_ptr<CostDataAbstract>;
using Control = std::optional<Eigen::VectorXd>;

// A class to derive from. T: CostModelAbstract, or a class of the library's.
template <class T>
struct PyCost : T {
  using T::T;
  void calc(const CostData& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    const Scope scope(*this, *data);
    if constexpr (std::is_abstract_v<T>) {
      PYBIND11_OVERRIDE_PURE(void, T, calc, data, x, u);
    } else {
      PYBIND11_OVERRIDE(void, T, calc, data, x, u);
    }
  }
  void calc(const CostData& data, const ConstVectorRef& x) override {
    const Scope scope(*this, *data);
    PYBIND11_OVERRIDE(void, T, calc, data, x);
  }
  void calcDiff(const CostData& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    const Scope scope(*this, *data);
    PYBIND11_OVERRIDE(void, T, calcDiff, data, x, u);
  }
  void calcDiff(const CostData& data, const ConstVectorRef& x) override {
    const Scope scope(*this, *data);
    PYBIND11_OVERRIDE(void, T, calcDiff, data, x);
  }
  CostData createData(DataCollector* collector) override {
    CostData data = created_in_python<T, CostDataAbstract>(this, collector);
    return data ? data : T::createData(collector);
  }
};

// Derivatives: views of data of a user's own cost, copies of others.
template <class Class, class M>
void add_derivative(Class& c, const char* name, M CostDerivatives::*made, M CostDataAbstract::*member,
                    const char* doc) {
  c.def_property(
      name,
      [made, member](py::object self) {
        auto& d = self.cast<CostDataAbstract&>();
        return d.own ? view(d.*member, self, true) : read_only(copy(d.whole_derivatives().*made));
      },
      [name, member](CostDataAbstract& d, py::handle values) {
        if (!d.own) throw py::type_error(std::string(name) + " is made of the residual's derivatives");
        assign(d.*member, values);
      },
      doc);
}

void add_cost_data(py::module_& m) {
  py::class_<CostDataAbstract, CostData> data(m, "CostDataAbstract", "The values of one cost.");
  data.def(py::init([](CostModelAbstract& model, const std::shared_ptr<Shared>& shared) {
             return std::make_shared<CostDataAbstract>(&model, shared->collector());
           }),
           py::arg("model"), py::arg("shared").none(false))
      .def_readwrite("cost", &CostDataAbstract::cost, "Value; set by calc.")
      .def_readonly("activation", &CostDataAbstract::activation, "ActivationDataAbstract.")
      .def_readonly("residual", &CostDataAbstract::residual, "ResidualDataAbstract.")
      .def_property_readonly(
          "shared", [](const CostDataAbstract& d) { return Scope::shared_of(&d); },
          "DataCollector, while calc and calcDiff of a class written in Python run.");
  using D = CostDerivatives;
  using Own = CostDataAbstract;
  add_derivative(data, "Lx", &D::Lx, &Own::Lx, "Gradient (ndx), without the weight.");
  add_derivative(data, "Lu", &D::Lu, &Own::Lu, "Gradient (nu), without the weight.");
  add_derivative(data, "Lxx", &D::Lxx, &Own::Lxx,
                 "Hessian (ndx, ndx), without the weight; Gauss-Newton's if the cost has a residual.");
  add_derivative(data, "Lxu", &D::Lxu, &Own::Lxu, "Hessian (ndx, nu), without the weight.");
  add_derivative(data, "Luu", &D::Luu, &Own::Luu, "Hessian (nu, nu), without the weight.");
  m.attr("CostDataResidual") = m.attr("CostDataAbstract");
}

void add_cost_models(py::module_& m) {
  using Activation = std::shared_ptr<ActivationModelAbstract>;
  using Residual = std::shared_ptr<ResidualModelAbstract>;
  using Abstract = CostModelAbstract;
  py::class_<Abstract, PyCost<Abstract>, std::shared_ptr<Abstract>> abstract(
      m, "CostModelAbstract",
      "A cost l(x, u).\n"
      "\n"
      "In a class derived from it, or from CostModelResidual, calc(self, data, x, u=None) sets data.cost, and\n"
      "calcDiff(self, data, x, u=None) sets data.Lx, Lu, Lxx, Lxu and Luu. Without u the node is terminal.\n"
      "createData(self, shared) may return data of a class derived from CostDataAbstract. The Hessians of such\n"
      "costs are\n"
      "dense; a residual takes less time.");
  add_cost_data(m);
  abstract
      .def(py::init<State, Activation, Residual>(), py::arg("state"), py::arg("activation").none(false),
           py::arg("residual").none(false))
      .def(py::init<State, Activation, std::size_t>(), py::arg("state"), py::arg("activation").none(false),
           py::arg("nu"), "Make a cost without a residual; calc may write data.residual.r.")
      .def(py::init<State, Residual>(), py::arg("state"), py::arg("residual").none(false))
      .def(py::init<State, Activation>(), py::arg("state"), py::arg("activation").none(false))
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"))
      .def(
          "calc",
          [](Abstract& c, const CostData& data, const ConstVectorRef& x, const Control& u) {
            u ? c.calc(data, x, *u) : c.calc(data, x);
          },
          py::arg("data").none(false), py::arg("x"), py::arg("u") = py::none(),
          "Compute data.cost, in an action model after its solve.")
      .def(
          "calcDiff",
          [](Abstract& c, const CostData& data, const ConstVectorRef& x, const Control& u) {
            u ? c.calcDiff(data, x, *u) : c.calcDiff(data, x);
          },
          py::arg("data").none(false), py::arg("x"), py::arg("u") = py::none(), "Compute the derivatives after calc.")
      .def(
          "createData",
          [](Abstract& c, const std::shared_ptr<Shared>& shared) { return c.createData(shared->collector()); },
          py::arg("shared").none(false), "Make a CostDataAbstract, for an overridden createData.")
      .def_property_readonly("state", &Abstract::get_state, "StateAbstract that it was made for.")
      .def_property_readonly("activation", &Abstract::get_activation, "The activation.")
      .def_property_readonly("residual", &Abstract::get_residual, "The residual.")
      .def_property_readonly("nu", &Abstract::get_nu, "Number of controls.")
      .def("__str__", &text_of<Abstract>);
  py::class_<CostModelResidual, PyCost<CostModelResidual>, Abstract, std::shared_ptr<CostModelResidual>>(
      m, "CostModelResidual", "The cost a(r(x, u)); without an activation 1/2 |r|^2.")
      .def(py::init<State, Activation, Residual>(), py::arg("state"), py::arg("activation").none(false),
           py::arg("residual").none(false))
      .def(py::init<State, Residual>(), py::arg("state"), py::arg("residual").none(false));
  py::class_<CostItem, std::shared_ptr<CostItem>>(m, "CostItem",
                                                  "A cost, its name, its weight, and whether it is active.")
      .def_readonly("name", &CostItem::name, "Name.")
      .def_readonly("cost", &CostItem::cost, "CostModelAbstract.")
      .def_readwrite("weight", &CostItem::weight, "Weight in the sum.")
      .def_readonly("active", &CostItem::active, "Whether it is active.");
  using Sum = CostModelSum;
  py::class_<Sum, std::shared_ptr<Sum>>(m, "CostModelSum", "A weighted sum of costs with names.")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"))
      .def("addCost", &Sum::addCost, py::arg("name"), py::arg("cost").none(false), py::arg("weight"),
           py::arg("active") = true, "Add a cost with a weight. A name that exists raises ValueError.")
      .def("removeCost", &Sum::removeCost, py::arg("name"), "Remove a cost by its name.")
      .def("changeCostStatus", &Sum::changeCostStatus, py::arg("name"), py::arg("active"),
           "Activate or deactivate a cost.")
      .def("getCostStatus", &Sum::getCostStatus, py::arg("name"), "Return whether a cost is active.")
      .def_property_readonly("state", &Sum::get_state, "StateAbstract that it was made for.")
      .def_property_readonly("costs", &Sum::get_costs, "{name: CostItem}.")
      .def_property_readonly("nu", &Sum::get_nu, "Number of controls.")
      .def_property_readonly("nr", &Sum::get_nr, "Number of rows of the active residuals.")
      .def_property_readonly("active_set", &Sum::get_active_set, "Names of the active ones.")
      .def_property_readonly("inactive_set", &Sum::get_inactive_set, "Names of the inactive ones.")
      .def("__str__", &text_of<Sum>);
}

void add_constraints(py::module_& m) {
  using Residual = std::shared_ptr<ResidualModelAbstract>;
  using One = ConstraintModelResidual;
  py::class_<One, std::shared_ptr<One>>(
      m, "ConstraintModelResidual",
      "A constraint lower <= r(x, u) <= upper, an equality if the bounds are equal; without bounds r = 0.")
      .def(py::init([](State state, Residual residual, const Bounds& lower, const Bounds& upper, bool T_act) {
             return std::make_shared<One>(std::move(state), std::move(residual), lower.x, upper.x, T_act);
           }),
           py::arg("state"), py::arg("residual").none(false), py::arg("lower"), py::arg("upper"),
           py::arg("T_act") = true)
      .def(py::init<State, Residual, bool>(), py::arg("state"), py::arg("residual").none(false),
           py::arg("T_act") = true)
      .def_property_readonly("residual", &One::get_residual, "The residual.")
      .def_property_readonly("ng", &One::get_ng, "Number of inequality constraints.")
      .def_property_readonly("nh", &One::get_nh, "Number of equality constraints.")
      .def_property_readonly("lb", &One::get_lb, "Lower bounds of the residual (nr).")
      .def_property_readonly("ub", &One::get_ub, "Upper bounds of the residual (nr).")
      .def("__str__", &text_of<One>);
  using Manager = ConstraintModelManager;
  py::class_<Manager, std::shared_ptr<Manager>>(m, "ConstraintModelManager", "A stack of constraints with names.")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"))
      .def("addConstraint", &Manager::addConstraint, py::arg("name"), py::arg("constraint").none(false),
           py::arg("active") = true, "Add a constraint. A name that exists raises ValueError.")
      .def("removeConstraint", &Manager::removeConstraint, py::arg("name"), "Remove a constraint by its name.")
      .def("changeConstraintStatus", &Manager::changeConstraintStatus, py::arg("name"), py::arg("active"),
           "Activate or deactivate a constraint.")
      .def("getConstraintStatus", &Manager::getConstraintStatus, py::arg("name"),
           "Return whether a constraint is active.")
      .def_property_readonly("ng", &Manager::get_ng, "Number of inequality constraints.")
      .def_property_readonly("nh", &Manager::get_nh, "Number of equality constraints.")
      .def_property_readonly("ng_T", &Manager::get_ng_T, "Number of inequality constraints in a terminal node.")
      .def_property_readonly("nh_T", &Manager::get_nh_T, "Number of equality constraints in a terminal node.")
      .def_property_readonly("lb", &Manager::get_lb, "Lower bounds of g (ng).")
      .def_property_readonly("ub", &Manager::get_ub, "Upper bounds of g (ng).")
      .def_property_readonly("active_set", &Manager::get_active_set, "Names of the active ones.")
      .def_property_readonly("inactive_set", &Manager::get_inactive_set, "Names of the inactive ones.")
      .def("__str__", &text_of<Manager>);
}

}  // namespace

void add_costs(py::module_& m) {
  add_cones(m);
  add_cost_models(m);
  add_constraints(m);
}

}  // namespace manycontact::python
