#pragma once
// The docstrings and parameters of docs/*.txt, which docs/assemble.py writes into a table when the module is built.

#include <pybind11/pybind11.h>

#include <span>
#include <string>

namespace py = pybind11;

namespace manycontact::python {

struct Text {
  const char* key;         // "solve", "Scene", "Scene.contacts"
  const char* parameters;  // one per line: "x", "x not None", "x=default" with an expression of Python, "*"
  const char* doc;
};

/// Returns all entries of docs/*.txt sorted by key; entries of overloads are in the order of docs/*.txt.
std::span<const Text> texts();

/// Returns the entry of a function, class or member; of overloads, the first entry that was not used yet. Throws if
/// there is no entry, except for methods with underscores, such as __repr__.
const Text& text_of(const std::string& key);

/// Throws if an entry of docs/*.txt was not used.
void expect_all_texts_taken();

/// Returns "status" for "... [with auto V = &manycontact::Report::status; ...]", the compiler's name of a function
/// template. Returns "" if V has no name, for example a number outside of an enumeration.
std::string name_in(const char* function);

/// Returns "status" for &Report::status, "kSparseLdl" for Method::kSparseLdl; "" if V is a number without enumerator.
template <auto V>
std::string name_of() {
  return name_in(__PRETTY_FUNCTION__);
}
/// Returns "Joint" for manycontact::Joint and for Handle<Joint>.
template <class V>
std::string type_name() {
  return name_in(__PRETTY_FUNCTION__);
}

/// Sets the module whose names may occur in default values.
void set_names_of_defaults(const py::module_& m);

/// A pybind11 attribute of a function: the parameters and docstring of its entry.
struct Described {
  const Text& text;
};
void describe(const Text& text, py::detail::function_record* function);

}  // namespace manycontact::python

namespace pybind11::detail {

template <>
struct process_attribute<manycontact::python::Described> : process_attribute_default<manycontact::python::Described> {
  static void init(const manycontact::python::Described& d, function_record* function) {
    manycontact::python::describe(d.text, function);
  }
};

}  // namespace pybind11::detail
