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

/// Every entry of docs/*.txt by its key; overloads are in their order.
std::span<const Text> texts();

/// The entry of a function, class or member; of overloads, the first one that was not asked for yet. Throws where there
/// is none. Methods with underscores, such as __repr__, need none.
const Text& text_of(const std::string& key);

/// Throws where an entry of docs/*.txt was not asked for.
void expect_all_texts_taken();

/// "status" of "... [with auto V = &manycontact::Report::status; ...]", what the compiler calls a function template; ""
/// where it has no name, as a number that is no member of an enumeration.
std::string name_in(const char* function);

/// "status" of &Report::status, "kSparseLdl" of Method::kSparseLdl; "" where an enumeration has no such member.
template <auto V>
std::string name_of() {
  return name_in(__PRETTY_FUNCTION__);
}
/// "Joint" of manycontact::Joint and of Handle<Joint>.
template <class V>
std::string type_name() {
  return name_in(__PRETTY_FUNCTION__);
}

/// The names in which default values are evaluated.
void set_names_of_defaults(const py::module_& m);

/// An attribute of a function of pybind11's: the parameters and docstring of its entry.
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
