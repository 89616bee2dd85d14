// The module manycontact._manycontact; the package's __init__.py shows its names as manycontact's.

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
  if (threads > kMost) throw py::value_error("at most " + std::to_string(kMost) + " threads are started");
  return threads;
}

namespace {

py::handle input_error_type;

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& e) {
    py::object error = input_error_type(e.what());
    error.attr("file") = e.file;
    error.attr("line") = e.line;
    error.attr("message") = e.message;
    PyErr_SetObject(input_error_type.ptr(), error.ptr());
  } catch (const std::logic_error& e) {  // std::invalid_argument too
    PyErr_SetString(PyExc_ValueError, e.what());
  }
}

}  // namespace

}  // namespace manycontact::python

PYBIND11_MODULE(_manycontact, m) {
  m.attr("__version__") = MANYCONTACT_VERSION;
  using namespace manycontact::python;
  const py::object own_name = m.attr("__name__");
  m.attr("__name__") = "manycontact";  // the module its classes and functions say they are of
  py::options options;
  options.disable_enum_members_docstring();

  m.attr("InputError") = py::exception<manycontact::InputError>(m, "InputError", PyExc_ValueError);
  input_error_type = m.attr("InputError");
  input_error_type.attr("__doc__") =
      "Bad input in a file: a ValueError \"FILE:LINE: what is wrong and what was expected\" with the attributes\n"
      "file, line and message.";
  py::register_exception_translator(translate);

  add_scenes(m);
  add_dynamics(m);
  add_simulation(m);
  add_action_parts(m);
  add_action(m);
  add_control(m);
  add_solvers(m);
  add_task(m);
  m.attr("__name__") = own_name;
}
