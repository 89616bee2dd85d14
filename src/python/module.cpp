// The module manycontact._manycontact. The package's __init__.py exports its names as those of `manycontact`.

#include "manycontact/io/input_error.hpp"
#include "manycontact/version.hpp"
#include "objects.hpp"

namespace manycontact::python {

std::shared_ptr<void> keep(py::handle object) {
  object.inc_ref();
  return {object.ptr(), [](void* held) {
            if (!Py_IsInitialized()) return;
            const py::gil_scoped_acquire gil;
            Py_DECREF(static_cast<PyObject*>(held));
          }};
}

int checked_threads(int threads) {
  constexpr int kMost = 1024;
  if (threads > kMost) throw py::value_error("threads is too large, at most " + std::to_string(kMost) + " is expected");
  return threads;
}

namespace {

py::handle input_error_type;

constexpr const char* kIsEmpty = "an object made by __new__ alone, without __init__, is empty";

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& e) {
    py::object error = input_error_type(e.what());
    error.attr("file") = e.file;
    error.attr("line") = e.line;
    error.attr("message") = e.message;
    PyErr_SetObject(input_error_type.ptr(), error.ptr());
  } catch (const py::cast_error& e) {  // shared objects throw this, too
    const bool empty = std::string(e.what()).find("non-held") != std::string::npos;
    PyErr_SetString(PyExc_TypeError, empty ? kIsEmpty : e.what());
  } catch (const std::logic_error& e) {  // includes std::invalid_argument
    PyErr_SetString(PyExc_ValueError, e.what());
  }
}

// Makes X.__new__(X) raise for all classes, because pybind11 would use uninitialised memory without a C++ object.
void refuse_empty_objects(const py::module_& m) {
  for (const auto& [name, member] : m.attr("__dict__").cast<py::dict>()) {
    if (!PyType_Check(member.ptr())) continue;
    if (auto* type = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(member.ptr())))
      type->operator_new = [](std::size_t) -> void* { throw py::type_error(kIsEmpty); };
  }
}

}  // namespace

}  // namespace manycontact::python

PYBIND11_MODULE(_manycontact, m) {
  m.attr("__version__") = MANYCONTACT_VERSION;
  using namespace manycontact::python;
  const py::object own_name = m.attr("__name__");
  m.attr("__name__") = "manycontact";  // becomes __module__ of the module's classes and functions
  py::options options;
  options.disable_enum_members_docstring();

  m.attr("InputError") = py::exception<manycontact::InputError>(m, "InputError", PyExc_ValueError);
  input_error_type = m.attr("InputError");
  input_error_type.attr("__doc__") =
      "Bad input in a file: a ValueError \"FILE:LINE: what is wrong and what was expected\" with the attributes\n"
      "file, line and message.";
  py::register_exception_translator(translate);

  set_names_of_defaults(m);
  add_models(m);
  add_scenes(m);
  add_rigid_bodies(m);
  add_options(m);
  add_dynamics(m);
  add_derivatives(m);
  add_batches(m);
  add_analysis(m);
  add_place(m);
  add_simulation(m);
  add_action_parts(m);
  add_residual_models(m);
  add_costs(m);
  add_action(m);
  add_control(m);
  add_twins(m);
  add_solvers(m);
  add_task(m);
  expect_all_texts_taken();
  refuse_empty_objects(m);
  m.attr("__name__") = own_name;
}
