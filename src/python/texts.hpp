#pragma once
// Docstrings and parameters from docs/*.txt, which docs/assemble.py writes into a table when the module is built.

#include <pybind11/pybind11.h>

#include <span>
#include <string>

namespace py = pybind11;

namespace manycontact::python {

struct Text {
  const char* key;         // such as "solve", "Scene", "Scene.contacts"
  const char* parameters;  // one per line: "x", "x not None", "x=default" (a Python expression), or "*"
  const char* doc;
};

/// Returns all entries of docs/*.txt sorted by key. Entries of overloads are in the order of docs/*.txt.
std::span<const Text> texts();

/// Returns the entry of a function, class or member. For an overload, this is the first entry that was not used yet.
/// Throws if there is no entry, except for methods with underscores such as __repr__.
const Text& text_of(const std::string& key);

void expect_all_texts_taken();  // throws if an entry of docs/*.txt was not used

/// Returns the name of V from the compiler's name of a function template, such as "status" from "... [with auto V =
/// &manycontact::Report::status; ...]". Returns "" if V has no name, as a number outside of an enumeration.
std::string name_in(const char* function);

/// Returns the name of V, such as "kSparseLdl" for Method::kSparseLdl, or "" if V is a number without enumerator.
template <auto V>
std::string name_of() {
  return name_in(__PRETTY_FUNCTION__);
}
/// Returns the name of a type, such as "Joint" for manycontact::Joint and for Handle<Joint>.
template <class V>
std::string type_name() {
  return name_in(__PRETTY_FUNCTION__);
}

/// Sets the module whose names may occur in default values of parameters.
void set_names_of_defaults(const py::module_& m);

struct Described {  // a pybind11 attribute that gives a function the parameters and the docstring of its entry
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
