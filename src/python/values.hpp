#pragma once
// Plain structures as Python values, which are copied, compared and pickled by member. Function members do not pickle.

#include <cmath>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "aggregate.hpp"
#include "handle.hpp"
#include "manycontact/dynamics/report.hpp"
#include "manycontact/model/model.hpp"

namespace manycontact::python {

template <class T>
inline constexpr bool is_matrix = false;
template <int R, int C, int O, int MR, int MC>
inline constexpr bool is_matrix<Eigen::Matrix<double, R, C, O, MR, MC>> = true;
template <class T>
inline constexpr bool is_vector = false;
template <class T>
inline constexpr bool is_vector<std::vector<T>> = true;
template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;
template <class T>
inline constexpr bool is_map = false;
template <class V>
inline constexpr bool is_map<std::unordered_map<std::string, V>> = true;
using SharedModel = std::shared_ptr<const Model>;

/// Returns references to a plain structure's members as a tuple. Structured bindings ensure that none is missing.
template <class T>
auto members(T& x) {
  return tied<std::remove_const_t<T>>(x);
}

template <class T>
bool equal(const T& a, const T& b) {
  if constexpr (is_matrix<T>) {
    return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
  } else if constexpr (std::is_floating_point_v<T>) {
    return a == b || (std::isnan(a) && std::isnan(b));  // quantities that were not estimated are NaN
  } else if constexpr (std::is_same_v<T, SolveTimes>) {
    return true;  // measured times are ignored
  } else if constexpr (std::is_same_v<T, SharedModel>) {
    return a == b || (a && b && equal(*a, *b));
  } else if constexpr (is_vector<T>) {
    if (a.size() != b.size()) return false;
    for (std::size_t k = 0; k < a.size(); ++k)
      if (!equal<typename T::value_type>(a[k], b[k])) return false;
    return true;
  } else if constexpr (is_optional<T>) {
    return a.has_value() == b.has_value() && (!a || equal(*a, *b));
  } else if constexpr (std::is_aggregate_v<T>) {
    const auto x = members(a), y = members(b);
    return [&]<std::size_t... I>(std::index_sequence<I...>) { return (equal(std::get<I>(x), std::get<I>(y)) && ...); }
    (std::make_index_sequence<std::tuple_size_v<decltype(x)>>());
  } else if constexpr (std::equality_comparable<T>) {
    return a == b;
  } else {
    throw py::type_error("the objects have a member that cannot be compared");
  }
}

/// Converts a value to tuples, lists, numbers, bytes and arrays.
template <class T>
py::object pack(const T& x) {
  if constexpr (std::is_arithmetic_v<T>) {
    return py::cast(x);
  } else if constexpr (std::is_enum_v<T>) {
    return py::int_(static_cast<long>(x));
  } else if constexpr (std::is_same_v<T, std::string>) {
    return py::bytes(x);
  } else if constexpr (is_matrix<T>) {
    return copy(x);
  } else if constexpr (std::is_same_v<T, SharedModel>) {
    return py::cast(std::const_pointer_cast<Model>(x));  // a model that several robots share is pickled once
  } else if constexpr (std::is_same_v<T, std::shared_ptr<const ModelStructure>>) {
    return py::none();  // finalize computes the ModelStructure again
  } else if constexpr (std::is_same_v<T, std::shared_ptr<const PairRows>>) {
    return py::none();  // contacts that users add have no PairRows
  } else if constexpr (is_vector<T>) {
    py::list out;
    for (const auto& item : x) out.append(pack<typename T::value_type>(item));
    return out;
  } else if constexpr (is_optional<T>) {
    return x ? py::object(py::make_tuple(pack(*x))) : py::object(py::none());
  } else if constexpr (is_map<T>) {
    py::dict out;
    for (const auto& [key, value] : x) out[py::bytes(key)] = pack(value);
    return out;
  } else if constexpr (std::is_aggregate_v<T>) {
    return std::apply([](const auto&... member) -> py::object { return py::make_tuple(pack(member)...); }, members(x));
  } else {
    throw py::type_error("the object has a member that cannot be pickled");
  }
}

template <class T>
void unpack(py::handle from, T& x) {
  if constexpr (std::is_arithmetic_v<T>) {
    x = from.cast<T>();
  } else if constexpr (std::is_enum_v<T>) {
    x = static_cast<T>(from.cast<long>());
  } else if constexpr (std::is_same_v<T, std::string>) {
    x = from.cast<std::string>();
  } else if constexpr (is_matrix<T>) {
    const auto a = py::array_t<double, py::array::f_style>::ensure(from);
    if (!a || a.ndim() != (T::IsVectorAtCompileTime ? 1 : 2))
      throw py::value_error("pickle: an array has a wrong number of dimensions");
    x = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>>(a.data(), a.shape(0),
                                                                                a.ndim() == 2 ? a.shape(1) : 1);
  } else if constexpr (std::is_same_v<T, SharedModel>) {
    x = from.cast<std::shared_ptr<Model>>();
  } else if constexpr (std::is_same_v<T, std::shared_ptr<const ModelStructure>> ||
                       std::is_same_v<T, std::shared_ptr<const PairRows>>) {
    x = nullptr;
  } else if constexpr (is_vector<T>) {
    x.clear();
    for (const py::handle item : py::reinterpret_borrow<py::list>(from)) {
      typename T::value_type value{};
      unpack(item, value);
      x.push_back(std::move(value));
    }
  } else if constexpr (is_optional<T>) {
    x.reset();
    if (from.is_none()) return;
    typename T::value_type value{};
    unpack(from.cast<py::tuple>()[0], value);
    x = std::move(value);
  } else if constexpr (is_map<T>) {
    x.clear();
    for (const auto& [key, value] : from.cast<py::dict>()) unpack(value, x[key.template cast<std::string>()]);
  } else if constexpr (std::is_aggregate_v<T>) {
    auto to = members(x);
    constexpr std::size_t n = std::tuple_size_v<decltype(to)>;
    const auto state = from.cast<py::tuple>();
    if (state.size() != n) throw py::value_error("pickle: the object was written by another version of manycontact");
    [&]<std::size_t... I>(std::index_sequence<I...>) { (unpack(state[I], std::get<I>(to)), ...); }
    (std::make_index_sequence<n>());
    if constexpr (std::is_same_v<T, Model>) finalize(x);
  } else {
    throw py::type_error("the object has a member that cannot be pickled");
  }
}

/// Adds copy and deepcopy to a class. Shared constants, such as models, remain shared.
template <class Held, class... Options>
Class<Held, Options...>& add_copy(Class<Held, Options...>& c) {
  using Value = ValueOf<Held>;
  return c.def("__copy__", [](const Held& x) { return Value::make(Value::get(x)); })
      .def(
          "__deepcopy__", [](const Held& x, const py::dict&) { return Value::make(Value::get(x)); }, py::arg("memo"));
}

/// Adds copy, deepcopy, == and pickle to a structure.
template <class Held, class... Options>
Class<Held, Options...>& add_value(Class<Held, Options...>& c) {
  using Value = ValueOf<Held>;
  const auto unpacked = [](const py::object& state) {
    typename Value::Type x{};
    unpack(state, x);
    return Value::make(std::move(x));
  };
  return add_copy(c)
      .def(
          "__eq__", [](const Held& x, const Held& y) { return equal(Value::get(x), Value::get(y)); }, py::is_operator(),
          py::arg("other"))
      .pickle([](const Held& x) { return pack(Value::get(x)); }, unpacked);
}

/// Binds a plain structure with copy, deepcopy, == and pickle.
template <class T, class... Options>
Class<T, Options...> value(py::module_& m, const std::string& name = type_name<T>()) {
  Class<T, Options...> c(m, name);
  add_value(c);
  return c;
}

}  // namespace manycontact::python
