#pragma once

#include <pybind11/stl.h>

#include <Eigen/SparseCore>
#include <memory>
#include <sstream>

#include "arrays.hpp"
#include "bind.hpp"
#include "enums.hpp"
#include "handle.hpp"
#include "values.hpp"

namespace manycontact::python {

/// Returns a pointer that keeps a Python object alive. Any thread may release it.
std::shared_ptr<void> keep(py::handle object);

/// Returns `threads`, or the number of OpenMP if it is 0. Throws ValueError for more than 1024.
int checked_threads(int threads);

/// Returns the output of operator<<, which __str__ returns in Python.
template <class T>
std::string text_of(const T& x) {
  std::ostringstream out;
  out << x;
  return out.str();
}

/// Adds a member matrix of constant size as a property: an array that views the matrix. Assignments write into it.
template <class T, class... Options, class M>
void view_property(Class<T, Options...>& c, const char* name, M member) {
  c.property(
      name, [member](py::object self) { return view(self.cast<T&>().*member, self, true); },
      [member](T& self, py::handle values) { assign(self.*member, values); });
}

/// Return a list of a scene's items, which can be accessed by number or name.
Items<Handle<Contact>> contacts_of(const std::shared_ptr<Scene>& scene);
Items<Handle<ExternalWrench>> wrenches_of(const std::shared_ptr<Scene>& scene);
Items<Handle<Spring>> springs_of(const std::shared_ptr<Scene>& scene);

/// Return the numbers of `given`. Throw ValueError if a number is not finite, or if there are not `size` numbers.
Eigen::Map<const Eigen::VectorXd> checked(const char* name, const Raw& given);
Eigen::Map<const Eigen::VectorXd> checked(const char* name, const Raw& given, Eigen::Index size);

/// Returns the integer values of members of an enumeration, such as Status, as an array.
template <class E>
py::array_t<std::int8_t> numbers_of(const std::vector<E>& members) {
  py::array_t<std::int8_t> out(static_cast<py::ssize_t>(members.size()));
  for (std::size_t i = 0; i < members.size(); ++i) out.mutable_data()[i] = static_cast<std::int8_t>(members[i]);
  return out;
}

/// wrenches_view returns an array (n, 6) that views n wrenches w, which belong to `owner`. set_wrenches copies such an
/// array to w.
py::array wrenches_view(const std::vector<Vec6<double>>& w, py::handle owner);
void set_wrenches(const char* name, py::handle values, std::vector<Vec6<double>>& w);
/// Returns a matrix (n, 6) with a copy of the n wrenches.
Eigen::MatrixXd rows_of_wrenches(const std::vector<Vec6<double>>& w);

/// Returns an array of bools that views the flags, which are 0 or 1, and keeps `owner` alive.
py::array_t<bool> flags_view(std::vector<char>& flags, py::handle owner);
/// Sets all flags from a sequence of as many bools, numpy bools, or numbers 0 and 1. name: for error messages.
void set_flags(const std::string& name, py::handle values, std::vector<char>& flags);
/// Converts `active` to one flag per contact of the scene. None means the contacts that are active in the scene.
std::vector<char> flags_of(const Scene& scene, const py::object& active);

/// Returns a sparse matrix as scipy.sparse.csc_matrix, which takes over its memory.
py::object scipy_csc(Eigen::SparseMatrix<double>&& given);

void add_models(py::module_& m);
void add_scenes(py::module_& m);
// For external wrenches and springs: add_force_classes must be called before add_scenes, and add_forces after it.
void add_force_classes(py::module_& m);
void add_forces(py::module_& m);
void add_rigid_bodies(py::module_& m);
void add_options(py::module_& m);
void add_dynamics(py::module_& m);
void add_derivatives(py::module_& m);
void add_batches(py::module_& m);
void add_analysis(py::module_& m);
void add_place(py::module_& m);
void add_simulation(py::module_& m);
void add_action_parts(py::module_& m);
void add_residual_models(py::module_& m);
void add_costs(py::module_& m);
void add_action(py::module_& m);
void add_control(py::module_& m);
void add_twins(py::module_& m);
void add_solvers(py::module_& m);
void add_task(py::module_& m);

/// Lets a shared_ptr to an object whose class is defined in Python keep the Python object alive.
template <class T>
struct KeepingCaster : py::detail::copyable_holder_caster<T, std::shared_ptr<T>> {
  using Base = py::detail::copyable_holder_caster<T, std::shared_ptr<T>>;
  bool load(py::handle source, bool convert) {
    if (!Base::load(source, convert)) return false;
    T* const object = static_cast<T*>(this->value);
    if (!object) return true;
    const py::detail::type_info* type = py::detail::get_type_info(typeid(*object), false);
    if (type && type->type == Py_TYPE(source.ptr())) return true;
    this->holder = std::shared_ptr<T>(keep(source), object);
    return true;
  }
};

}  // namespace manycontact::python

#define MANYCONTACT_KEEPS_PYTHON(T)                                                  \
  namespace pybind11::detail {                                                       \
  template <>                                                                        \
  struct type_caster<std::shared_ptr<T>> : manycontact::python::KeepingCaster<T> {}; \
  }
