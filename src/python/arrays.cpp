#include "arrays.hpp"

namespace manycontact::python {

std::string shape_of(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) text += (i ? ", " : "") + std::to_string(array.shape(i));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

namespace {

// Returns whether the array can be read in place: aligned float64 in this machine's byte order, in C's order.
bool is_plain(const py::array& array) {
  return py::isinstance<py::array_t<double, py::array::c_style>>(array) &&
         (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
}

py::array as_array(py::handle source) {
  if (py::isinstance<py::array>(source)) return py::reinterpret_borrow<py::array>(source);
  if (!py::isinstance<py::sequence>(source) || py::isinstance<py::str>(source) || py::isinstance<py::bytes>(source))
    return py::reinterpret_steal<py::array>(py::handle());
  return py::array::ensure(source);
}

}  // namespace

Doubles as_doubles(py::handle source) {
  const Doubles none = py::reinterpret_steal<Doubles>(py::handle());
  const py::array array = as_array(source);
  if (!array || array.ndim() == 0) return none;
  if (is_plain(array)) return py::reinterpret_borrow<Doubles>(array);
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u' && kind != 'b') return none;
  using Contiguous = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const Contiguous copied = Contiguous::ensure(array);
  return copied ? py::reinterpret_borrow<Doubles>(copied) : none;
}

void expect_numbers_in(py::handle values) {
  if (values.is_none() || py::isinstance<py::str>(values) || py::isinstance<py::bytes>(values))
    throw py::type_error("numbers are expected, not " + std::string(py::str(py::type::of(values).attr("__name__"))));
}

Doubles checked_doubles(py::handle source, int dimensions, Eigen::Index rows, Eigen::Index cols) {
  Doubles a = as_doubles(source);
  if (!a) return a;
  if (a.ndim() != dimensions)
    throw py::value_error(std::string(dimensions == 1 ? "a vector" : "a matrix") +
                          " is expected, not an array of shape " + shape_of(a));
  if (rows != Eigen::Dynamic && a.shape(0) != rows && dimensions == 1)
    throw py::value_error(std::to_string(rows) + " numbers are expected, not " + std::to_string(a.shape(0)));
  if (dimensions == 2 &&
      ((rows != Eigen::Dynamic && a.shape(0) != rows) || (cols != Eigen::Dynamic && a.shape(1) != cols)))
    throw py::value_error("a matrix of shape (" + std::to_string(rows) + ", " + std::to_string(cols) +
                          ") is expected, not of " + shape_of(a));
  return a;
}

void check_numbers(const char* name, const double* x, Eigen::Index size, bool infinite) {
  if (Eigen::Map<const Eigen::VectorXd>(x, size).allFinite()) return;
  for (Eigen::Index i = 0; i < size; ++i) {
    if (std::isfinite(x[i]) || (infinite && !std::isnan(x[i]))) continue;
    const std::string which = *name ? std::string(name) + "[" + std::to_string(i) + "]" : "number " + std::to_string(i);
    throw py::value_error(which + " is " +
                          (std::isnan(x[i]) ? "nan"
                           : x[i] > 0       ? "inf"
                                            : "-inf") +
                          ", a finite number is expected");
  }
}

}  // namespace manycontact::python
