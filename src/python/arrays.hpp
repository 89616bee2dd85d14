#pragma once
// Converts between numpy arrays and Eigen's vectors and matrices, instead of pybind11/eigen.h. Wrong shapes and numbers
// that are not finite raise a ValueError with the reason. Objects that are not arrays of numbers raise a TypeError.
//   Eigen matrices, vectors    copied in and out; properties return read-only copies
//   Ref<const VectorXd>        not copied in if the array is contiguous float64; copied out
//   Bounds, Raw                vectors that may have infinite numbers (Bounds), or any numbers (Raw)
//   view(...)                  an array that views the memory of a matrix, and keeps the matrix's owner alive

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>

#include "manycontact/abi.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace py = pybind11;

namespace manycontact::python {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using Doubles = py::array_t<double, py::array::forcecast>;

struct Bounds {
  Eigen::VectorXd x;
};

struct Raw {
  Doubles array;
  Eigen::Map<const Eigen::VectorXd> vector() const { return {array.data(), array.size()}; }
};

std::string shape_of(const py::array& array);  // returns the shape as text, such as "(3, 4)"

/// Returns `source` as float64 in C's order, or null if it is neither an array nor a sequence of numbers.
Doubles as_doubles(py::handle source);

/// Returns as_doubles(source). Throws ValueError for a wrong number of dimensions or size (Eigen::Dynamic: any).
Doubles checked_doubles(py::handle source, int dimensions, Eigen::Index rows, Eigen::Index cols);

/// Throws ValueError if a number is not finite, or, with `infinite`, if it is NaN. name: the argument's name, or "".
void check_numbers(const char* name, const double* x, Eigen::Index size, bool infinite = false);

inline py::array read_only(py::array array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// Returns a numpy array that views numbers of `owner` and keeps `owner` alive. Strides are in numbers, not in bytes.
inline py::array view(const double* x, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                      py::handle owner, bool writeable) {
  for (py::ssize_t& s : strides) s *= static_cast<py::ssize_t>(sizeof(double));
  py::array out(py::dtype::of<double>(), std::move(shape), std::move(strides), x, owner);
  return writeable ? out : read_only(std::move(out));
}

template <class M>
py::array view(const M& m, py::handle owner, bool writeable) {
  if constexpr (M::IsVectorAtCompileTime) return view(m.data(), {m.size()}, {m.innerStride()}, owner, writeable);
  return view(m.data(), {m.rows(), m.cols()}, {m.rowStride(), m.colStride()}, owner, writeable);
}

template <class M>
py::array copy(const M& m) {
  return view(m, py::none(), true).attr("copy")();
}

/// Returns copy(m), which is read-only if a property returns it (only properties have the policy reference_internal).
template <class M>
py::array copy(const M& m, py::return_value_policy policy) {
  return policy == py::return_value_policy::reference_internal ? read_only(copy(m)) : copy(m);
}

void expect_numbers_in(py::handle values);  // throws TypeError for None and text, which numpy would convert to numbers

/// Assigns values to m as `m[...] = values` does in numpy: `values` has the shape of m, or broadcasts to it.
template <class M>
void assign(M& m, py::handle values) {
  expect_numbers_in(values);
  view(m, py::none(), true).attr("__setitem__")(py::ellipsis(), values);
}

}  // namespace manycontact::python

namespace pybind11::detail {

template <int R, int C, int O, int MR, int MC>
struct type_caster<Eigen::Matrix<double, R, C, O, MR, MC>> {
  using Matrix = Eigen::Matrix<double, R, C, O, MR, MC>;
  PYBIND11_TYPE_CASTER(Matrix, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    using namespace manycontact::python;
    constexpr bool vector = Matrix::IsVectorAtCompileTime;
    const Doubles a = checked_doubles(source, vector ? 1 : 2, vector ? Matrix::SizeAtCompileTime : R, vector ? 1 : C);
    if (!a) return false;
    if constexpr (vector) {
      value = Eigen::Map<const Matrix>(a.data(), a.size());
    } else {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      value = Eigen::Map<const RowMajor>(a.data(), a.shape(0), a.shape(1));
    }
    check_numbers("", value.data(), value.size());
    return true;
  }
  static handle cast(const Matrix& m, return_value_policy policy, handle) {
    return manycontact::python::copy(m, policy).release();
  }
};

template <>
struct type_caster<manycontact::ConstVectorRef> {
  using Vector = manycontact::ConstVectorRef;
  static constexpr auto name = const_name("numpy.ndarray");
  template <class>
  using cast_op_type = const Vector&;

  bool load(handle source, bool) {
    using namespace manycontact::python;
    array_ = checked_doubles(source, 1, Eigen::Dynamic, 1);
    if (!array_) return false;
    check_numbers("", array_.data(), array_.size());
    value_.emplace(Eigen::Map<const Eigen::VectorXd>(array_.data(), array_.size()));
    return true;
  }
  operator const Vector&() { return *value_; }
  static handle cast(const Vector& v, return_value_policy policy, handle) {
    return manycontact::python::copy(v, policy).release();
  }

 private:
  manycontact::python::Doubles array_;
  std::optional<Vector> value_;
};

template <>
struct type_caster<manycontact::python::Bounds> {
  PYBIND11_TYPE_CASTER(manycontact::python::Bounds, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    using namespace manycontact::python;
    const Doubles a = checked_doubles(source, 1, Eigen::Dynamic, 1);
    if (!a) return false;
    value.x = Eigen::Map<const Eigen::VectorXd>(a.data(), a.size());
    check_numbers("", value.x.data(), value.x.size(), true);
    return true;
  }
};

template <>
struct type_caster<manycontact::python::Raw> {
  PYBIND11_TYPE_CASTER(manycontact::python::Raw, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    value.array = manycontact::python::checked_doubles(source, 1, Eigen::Dynamic, 1);
    return static_cast<bool>(value.array);
  }
};

}  // namespace pybind11::detail
