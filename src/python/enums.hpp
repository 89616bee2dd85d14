#pragma once
// Enumerations in Python. A member can be given in any of these forms:
//   Method.SPARSE_LDL    'sparse-ldl'    'sparse_ldl'    'SPARSE_LDL'

#include <pybind11/pybind11.h>

#include <concepts>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "texts.hpp"

namespace py = pybind11;

namespace manycontact::python {

std::string plain(std::string name);  // returns the name in lower case with '-' between its words

/// The names of the members of an enumeration, which `enumeration` sets.
template <class E>
struct Names {
  struct Member {
    E value;
    std::string word;    // the name in files and on the command line
    std::string python;  // the name in Python, such as "SPARSE_LDL"
  };
  static inline std::string what;  // the word for a member in error messages, such as "method"
  static inline std::vector<Member> members;
};

/// Returns the member called `name` in any of the forms above. Otherwise throws a ValueError that lists the members.
template <class E>
E value_called(const std::string& name) {
  const std::string asked = plain(name);
  std::string expected;
  for (const auto& member : Names<E>::members) {
    if (asked == plain(member.word) || asked == plain(member.python)) return member.value;
    expected += (expected.empty() ? "'" : ", '") + member.word + "'";
  }
  throw py::value_error("unknown " + Names<E>::what + " '" + name + "', expected one of " + expected);
}

/// A pybind11 caster that accepts members of the enumeration, and strings that name a member.
template <class E>
struct EnumCaster : py::detail::type_caster_base<E> {
  bool load(py::handle source, bool convert) {
    if (!py::isinstance<py::str>(source)) return py::detail::type_caster_base<E>::load(source, convert);
    named_ = value_called<E>(source.cast<std::string>());
    this->value = &named_;
    return true;
  }

 private:
  E named_{};
};

/// Returns an enumerator's Python name, such as "SPARSE_LDL" for "kSparseLdl"; without a leading k, the name itself.
std::string python_name(const std::string& enumerator);

/// Binds an enumeration. Its entry in docs/*.txt contains the word for a member in error messages. values: all members,
/// if the enumeration is unscoped; members of a scoped enumeration are found by their numbers from 0. If there is no
/// to_string, strings name members as Python does.
template <class E, E... values>
void enumeration(py::module_& m, const char* prefix = "") {
  constexpr bool has_words = requires(E x) {
    { to_string(x) } -> std::convertible_to<std::string>;
  };
  constexpr int kMost = 32;
  const std::string name = type_name<E>();
  const Text& entry = text_of(name);
  Names<E>::what = entry.parameters;
  Names<E>::members.clear();
  const auto add = [&](E value, const std::string& enumerator) {
    if (enumerator.empty()) return;
    const std::string python = prefix + python_name(enumerator);
    std::string word = python;
    if constexpr (has_words) word = to_string(value);
    if (!has_words || word.find(' ') != std::string::npos) word = plain(python);
    if (word.starts_with('-')) word.erase(0, 1);  // "-0", the name of _0, becomes "0"
    Names<E>::members.push_back({value, word, python});
  };
  if constexpr (sizeof...(values) > 0)
    (add(values, name_of<values>()), ...);
  else
    [&]<int... I>(std::integer_sequence<int, I...>) { (add(static_cast<E>(I), name_of<static_cast<E>(I)>()), ...); }
  (std::make_integer_sequence<int, kMost>());
  const std::string doc =
      std::string(entry.doc) + "\n\nFunctions also accept names, such as '" + Names<E>::members.front().word + "'.";
  py::enum_<E> e(m, name.c_str(), doc.c_str());
  for (const auto& member : Names<E>::members) e.value(member.python.c_str(), member.value);
  const auto text_of_member = [](E x) -> std::string {
    if constexpr (has_words) return to_string(x);
    for (const auto& member : Names<E>::members)
      if (member.value == x) return member.word;
    return "?";
  };
  e.def("__str__", text_of_member, py::prepend());
  e.attr("value").attr("__doc__") = "Number of the member.";
}

}  // namespace manycontact::python

template <class E>
struct pybind11::detail::type_caster<E, std::enable_if_t<std::is_enum_v<E>>> : manycontact::python::EnumCaster<E> {};
