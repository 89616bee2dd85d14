#pragma once
// Which classes of the action and control floors users may derive from in Python, and properties of action data.

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

/// What the data of action models, differential or not, have in common.
template <class Class>
void add_action_data(Class& c) {
  using T = typename Class::type;
  c.def_readwrite("cost", &T::cost, "By calc.");
  member_view(c, "Fu", &T::Fu, "By calcDiff: derivative of the dynamics by u.");
  member_view(c, "Fx", &T::Fx, "By calcDiff: derivative of the dynamics by x, on the tangent space.");
  member_view(c, "Lx", &T::Lx, "(ndx): by calcDiff.");
  member_view(c, "Lu", &T::Lu, "(nu): by calcDiff.");
  member_view(c, "Lxx", &T::Lxx, "(ndx, ndx): by calcDiff.");
  member_view(c, "Lxu", &T::Lxu, "(ndx, nu): by calcDiff.");
  member_view(c, "Luu", &T::Luu, "(nu, nu): by calcDiff.");
  resized_member(c, "r", &T::r, "(nr): by calc.");
  resized_member(c, "g", &T::g, "(ng), lb <= g <= ub: by calc.");
  resized_member(c, "h", &T::h, "(nh), h = 0: by calc.");
  resized_member(c, "Gx", &T::Gx, "(ng, ndx): by calcDiff.");
  resized_member(c, "Gu", &T::Gu, "(ng, nu): by calcDiff.");
  resized_member(c, "Hx", &T::Hx, "(nh, ndx): by calcDiff.");
  resized_member(c, "Hu", &T::Hu, "(nh, nu): by calcDiff.");
}

/// What action models, differential or not, have in common. Data: of the abstract class.
template <class Data, class Class>
void add_action_model(Class& c) {
  using T = typename Class::type;
  using Shared = std::shared_ptr<Data>;
  using Control = std::optional<Eigen::VectorXd>;
  c.def_property_readonly("state", &T::get_state)
      .def_property_readonly("nu", &T::get_nu)
      .def_property_readonly("nr", &T::get_nr)
      .def_property_readonly("ng", &T::get_ng)
      .def_property_readonly("nh", &T::get_nh)
      .def_property_readonly("ng_T", &T::get_ng_T)
      .def_property_readonly("nh_T", &T::get_nh_T)
      .def_property_readonly("has_control_limits", &T::get_has_control_limits)
      .def_property(
          "u_lb", &T::get_u_lb, [](T& x, const Bounds& b) { x.set_u_lb(b.x); }, "(nu)")
      .def_property(
          "u_ub", &T::get_u_ub, [](T& x, const Bounds& b) { x.set_u_ub(b.x); }, "(nu)")
      .def_property(
          "g_lb", &T::get_g_lb, [](T& x, const Bounds& b) { x.set_g_lb(b.x); }, "(ng)")
      .def_property(
          "g_ub", &T::get_g_ub, [](T& x, const Bounds& b) { x.set_g_ub(b.x); }, "(ng)")
      .def("createData", &T::createData, Unlocked())
      .def(
          "calc",
          [](T& x, const Shared& data, const ConstVectorRef& state, const Control& u) {
            u ? x.calc(data, state, *u) : x.calc(data, state);
          },
          py::arg("data").none(false), py::arg("x"), py::arg("u") = py::none(), Unlocked(),
          "Dynamics, cost and constraints at x (nx), u (nu); without u those of a terminal node.")
      .def(
          "calcDiff",
          [](T& x, const Shared& data, const ConstVectorRef& state, const Control& u) {
            u ? x.calcDiff(data, state, *u) : x.calcDiff(data, state);
          },
          py::arg("data").none(false), py::arg("x"), py::arg("u") = py::none(), Unlocked(),
          "Derivatives at the last calc.")
      .def("quasiStatic", &T::quasiStatic_x, py::arg("data").none(false), py::arg("x"), py::arg("maxiter") = 100,
           py::arg("tol") = 1e-9, Unlocked(), "Controls (nu) that keep x (nx) still.")
      .def("checkData", &T::checkData, py::arg("data"), Unlocked(), "Whether the data serve this model.")
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
  // By Python's quasiStatic(self, data, x, maxiter, tol), which returns u; false where the class has none.
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
