#pragma once
// Classes of action models and solvers that users may derive from in Python, and properties of action data.

#include <typeinfo>

#include "manycontact/action/activation.hpp"
#include "manycontact/action/actuation.hpp"
#include "manycontact/action/cost.hpp"
#include "manycontact/action/diff_action.hpp"
#include "manycontact/action/residual.hpp"
#include "manycontact/control/solver.hpp"
#include "objects.hpp"

MANYCONTACT_KEEPS_PYTHON(manycontact::ActivationModelAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::ActivationDataAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::ResidualModelAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::ResidualDataAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::CostModelAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::CostDataAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::ActuationModelAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::ActuationDataAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::DifferentialActionModelAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::DifferentialActionDataAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::ActionModelAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::ActionDataAbstract)
MANYCONTACT_KEEPS_PYTHON(manycontact::CallbackAbstract)

namespace manycontact::python {

/// The data that a createData of Python's returned.
template <class Data>
std::shared_ptr<Data> made(std::shared_ptr<Data> data) {
  if (!data) throw py::value_error("createData returned None, data are expected");
  return data;
}

/// A member of action data that the library's models resize: an array on it in data of models written in Python, which
/// keep their size, else a copy that cannot be written into. Assignment writes into it in either.
template <class Class, class M>
void resized_member(Class& c, const char* name, M member, const char* doc) {
  using T = typename Class::type;
  c.def_property(
      name,
      [member](py::object self) {
        T& data = self.cast<T&>();
        if (typeid(data) == typeid(T)) return view(data.*member, self, true);
        py::array out = copy(data.*member);
        py::detail::array_proxy(out.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
        return out;
      },
      [member](T& data, py::handle values) { assign(data.*member, values); }, doc);
}

/// Members that the data of action models, differential or not, have in common.
template <class Class>
void add_action_data(Class& c) {
  using T = typename Class::type;
  c.def_readwrite("cost", &T::cost, "Cost; set by calc.");
  member_view(c, "Fu", &T::Fu, "Derivative of the dynamics with respect to u; set by calcDiff.");
  member_view(c, "Fx", &T::Fx, "Derivative of the dynamics with respect to x, on the tangent space; set by calcDiff.");
  member_view(c, "Lx", &T::Lx, "Gradient of the cost (ndx); set by calcDiff.");
  member_view(c, "Lu", &T::Lu, "Gradient of the cost (nu); set by calcDiff.");
  member_view(c, "Lxx", &T::Lxx, "Hessian of the cost (ndx, ndx); set by calcDiff.");
  member_view(c, "Lxu", &T::Lxu, "Hessian of the cost (ndx, nu); set by calcDiff.");
  member_view(c, "Luu", &T::Luu, "Hessian of the cost (nu, nu); set by calcDiff.");
  resized_member(c, "r", &T::r, "Residuals (nr); set by calc.");
  resized_member(c, "g", &T::g, "Inequality constraints (ng), g_lb <= g <= g_ub; set by calc.");
  resized_member(c, "h", &T::h, "Equality constraints (nh), h = 0; set by calc.");
  resized_member(c, "Gx", &T::Gx, "Derivative of g (ng, ndx); set by calcDiff.");
  resized_member(c, "Gu", &T::Gu, "Derivative of g (ng, nu); set by calcDiff.");
  resized_member(c, "Hx", &T::Hx, "Derivative of h (nh, ndx); set by calcDiff.");
  resized_member(c, "Hu", &T::Hu, "Derivative of h (nh, nu); set by calcDiff.");
}

/// Members that action models, differential or not, have in common. `Data` is that of the abstract class.
template <class Data, class Class>
void add_action_model(Class& c) {
  using T = typename Class::type;
  using Shared = std::shared_ptr<Data>;
  using Control = std::optional<Eigen::VectorXd>;
  c.def_property_readonly("state", &T::get_state, "StateAbstract that it was made for.")
      .def_property_readonly("nu", &T::get_nu, "Number of controls.")
      .def_property_readonly("nr", &T::get_nr, "Number of rows of the residual.")
      .def_property_readonly("ng", &T::get_ng, "Number of inequality constraints.")
      .def_property_readonly("nh", &T::get_nh, "Number of equality constraints.")
      .def_property_readonly("ng_T", &T::get_ng_T, "Number of inequality constraints in a terminal node.")
      .def_property_readonly("nh_T", &T::get_nh_T, "Number of equality constraints in a terminal node.")
      .def_property_readonly("has_control_limits", &T::get_has_control_limits,
                             "Whether any limit of controls is finite.")
      .def_property(
          "u_lb", &T::get_u_lb, [](T& x, const Bounds& b) { x.set_u_lb(b.x); },
          "Lower limits of controls (nu); -inf: none.")
      .def_property(
          "u_ub", &T::get_u_ub, [](T& x, const Bounds& b) { x.set_u_ub(b.x); },
          "Upper limits of controls (nu); inf: none.")
      .def_property(
          "g_lb", &T::get_g_lb, [](T& x, const Bounds& b) { x.set_g_lb(b.x); }, "Lower bounds of g (ng).")
      .def_property(
          "g_ub", &T::get_g_ub, [](T& x, const Bounds& b) { x.set_g_ub(b.x); }, "Upper bounds of g (ng).")
      .def("createData", &T::createData, Unlocked(), "Create data of this model.")
      .def(
          "calc",
          [](T& x, const Shared& data, const ConstVectorRef& state, const Control& u) {
            u ? x.calc(data, state, *u) : x.calc(data, state);
          },
          py::arg("data").none(false), py::arg("x"), py::arg("u") = py::none(), Unlocked(),
          "Compute dynamics, cost and constraints at x (nx), u (nu); without u those of a terminal node.")
      .def(
          "calcDiff",
          [](T& x, const Shared& data, const ConstVectorRef& state, const Control& u) {
            u ? x.calcDiff(data, state, *u) : x.calcDiff(data, state);
          },
          py::arg("data").none(false), py::arg("x"), py::arg("u") = py::none(), Unlocked(),
          "Compute the derivatives at the last calc.")
      .def("quasiStatic", &T::quasiStatic_x, py::arg("data").none(false), py::arg("x"), py::arg("maxiter") = 100,
           py::arg("tol") = 1e-9, Unlocked(), "Compute controls (nu) that keep x (nx) at rest.")
      .def("checkData", &T::checkData, py::arg("data"), Unlocked(),
           "Return whether the data were created by a model of this kind, with the same sizes.")
      .def("__str__", &text_of<T>);
}

/// A class to derive from: Python's calc(data, x, u=None), calcDiff(data, x, u=None), createData(). In OpenMP's threads
/// too: they take turns, by the GIL.
template <class Abstract, class AbstractData>
struct PyActionModel : Abstract {
  using Abstract::Abstract;
  using Data = std::shared_ptr<AbstractData>;
  void calc(const Data& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    PYBIND11_OVERRIDE_PURE(void, Abstract, calc, data, x, u);
  }
  void calc(const Data& data, const ConstVectorRef& x) override { PYBIND11_OVERRIDE(void, Abstract, calc, data, x); }
  void calcDiff(const Data& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    PYBIND11_OVERRIDE_PURE(void, Abstract, calcDiff, data, x, u);
  }
  void calcDiff(const Data& data, const ConstVectorRef& x) override {
    PYBIND11_OVERRIDE(void, Abstract, calcDiff, data, x);
  }
  Data createData() override {
    return made([&]() -> Data { PYBIND11_OVERRIDE(Data, Abstract, createData, ); }());
  }
  bool checkData(const Data& data) override { PYBIND11_OVERRIDE(bool, Abstract, checkData, data); }
  void quasiStatic(const Data& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter, double tol) override {
    if (!own_quasi_static(data, u, x, maxiter, tol)) Abstract::quasiStatic(data, u, x, maxiter, tol);
  }

 private:
  // Calls Python's quasiStatic(self, data, x, maxiter, tol), which returns u; false if the class has none.
  bool own_quasi_static(const Data& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter, double tol) {
    const py::gil_scoped_acquire gil;
    const py::function own = py::get_override(static_cast<const Abstract*>(this), "quasiStatic");
    if (!own) return false;
    const auto given = own(data, x, maxiter, tol).template cast<Eigen::VectorXd>();
    check_size("quasiStatic", "u", given.size(), this->get_nu());
    u = given;
    return true;
  }
};

}  // namespace manycontact::python
