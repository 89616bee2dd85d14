#pragma once
// Classes of action models and solvers that users may derive from in Python, and properties of action data.

#include <typeinfo>

#include "manycontact/action/activation.hpp"
#include "manycontact/action/actuation.hpp"
#include "manycontact/action/cost.hpp"
#include "manycontact/action/diff_action.hpp"
#include "manycontact/action/residual.hpp"
#include "manycontact/action/state.hpp"
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

/// Calls the method `name` that Python defines, otherwise that of T. If T is abstract, a missing method is an error.
#define MANYCONTACT_OVERRIDE(result, T, name, ...)        \
  if constexpr (std::is_abstract_v<T>) {                  \
    PYBIND11_OVERRIDE_PURE(result, T, name, __VA_ARGS__); \
  } else {                                                \
    PYBIND11_OVERRIDE(result, T, name, __VA_ARGS__);      \
  }

namespace manycontact::python {

using State = std::shared_ptr<StateMultibody>;

/// Returns the data that createData of Python returned. Raises ValueError for None.
template <class Data>
std::shared_ptr<Data> made(std::shared_ptr<Data> data) {
  if (!data) throw py::value_error("createData returned None, data are expected");
  return data;
}

/// Adds a member of action data that the library's models resize. Reading returns a writable view for models written in
/// Python, whose data have fixed sizes, and a read-only copy for other models. Assignment writes into the member.
template <class T, class... Options, class... Given>
void add_resized(Class<T, Options...>& c, Given... given) {
  const auto add = [&c](const char* name, auto member) {
    c.property(
        name,
        [member](py::object self) {
          T& data = self.cast<T&>();
          return typeid(data) == typeid(T) ? view(data.*member, self, true) : read_only(copy(data.*member));
        },
        [member](T& data, py::handle values) { assign(data.*member, values); });
  };
  in_groups<2>(add, given...);
}

/// Raises ValueError unless `values` has the shape of `matrix`. name: for messages.
template <class M>
void expect_shape(const char* name, const Eigen::MatrixXd& values, const M& matrix) {
  if (values.rows() != matrix.rows() || values.cols() != matrix.cols())
    throw py::value_error(std::string(name) + ": a matrix of shape (" + std::to_string(matrix.rows()) + ", " +
                          std::to_string(matrix.cols()) + ") is expected");
}

/// Adds the members that data of differential and discrete action models have in common.
template <class T, class... Options>
void add_action_data(Class<T, Options...>& c) {
  c.template write<&T::cost>().template views<&T::Fu, &T::Fx, &T::Lx, &T::Lu, &T::Lxx, &T::Lxu, &T::Luu>();
  add_resized(c, "r", &T::r, "g", &T::g, "h", &T::h, "Gx", &T::Gx, "Gu", &T::Gu, "Hx", &T::Hx, "Hu", &T::Hu);
}

/// Adds calc(data, x, u=None) and calcDiff(data, x, u=None).
template <class Data, class T, class... Options, class... Extra>
void add_calc(Class<T, Options...>& c, const Extra&... extra) {
  using Shared = std::shared_ptr<Data>;
  using Control = std::optional<Eigen::VectorXd>;
  c.def(
      "calc",
      [](T& model, const Shared& data, const ConstVectorRef& x, const Control& u) {
        u ? model.calc(data, x, *u) : model.calc(data, x);
      },
      extra...);
  c.def(
      "calcDiff",
      [](T& model, const Shared& data, const ConstVectorRef& x, const Control& u) {
        u ? model.calcDiff(data, x, *u) : model.calcDiff(data, x);
      },
      extra...);
}

/// Adds a property of bounds, which may be infinite.
template <class T, class... Options, class... Given>
void add_bounds(Class<T, Options...>& c, Given... given) {
  const auto add = [&c](const char* name, auto get, auto set) {
    c.property(name, get, [set](T& x, const Bounds& b) { (x.*set)(b.x); });
  };
  in_groups<3>(add, given...);
}

/// Adds the members that differential and discrete action models share. Data: class of the abstract model's data.
template <class Data, class T, class... Options>
void add_action_model(Class<T, Options...>& c) {
  c.read("state", &T::get_state, "nu", &T::get_nu, "nr", &T::get_nr, "ng", &T::get_ng, "nh", &T::get_nh, "ng_T",
         &T::get_ng_T, "nh_T", &T::get_nh_T, "has_control_limits", &T::get_has_control_limits);
  add_bounds(c, "u_lb", &T::get_u_lb, &T::set_u_lb, "u_ub", &T::get_u_ub, &T::set_u_ub, "g_lb", &T::get_g_lb,
             &T::set_g_lb, "g_ub", &T::get_g_ub, &T::set_g_ub);
  c.unlocked("createData", &T::createData);
  add_calc<Data>(c, Unlocked());
  c.unlocked("quasiStatic", &T::quasiStatic_x, "checkData", &T::checkData).methods("__str__", &text_of<T>);
}

/// A base class for models in Python. Calls their calc, calcDiff (data, x, u=None) and createData with the GIL.
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
  // Calls quasiStatic(self, data, x, maxiter, tol) of Python, which returns u. Returns false if there is none.
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
