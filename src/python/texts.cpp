#include <pybind11/eval.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <stdexcept>

#include "enums.hpp"

namespace manycontact::python {

namespace {

constexpr Text kNone{"", "", ""};
constexpr std::string_view kNotNone = " not None";

std::map<std::string, std::size_t> taken;  // value: number of overloads of the key that were used
py::handle names_of_defaults;

// Stores the name permanently, because pybind11 keeps the pointer until the function is complete.
const char* kept(std::string_view name) {
  static std::set<std::string> names;
  return names.emplace(name).first->c_str();
}

py::object value_of(const char* expression) {
  py::dict known;
  known["numpy"] = py::module_::import("numpy");
  return py::eval(expression, known, py::reinterpret_borrow<py::object>(names_of_defaults));
}

void add_parameter(std::string_view parameter, py::detail::function_record* function) {
  using namespace py::detail;
  if (parameter == "*") return process_attribute<py::kw_only>::init({}, function);
  const std::size_t equals = parameter.find('=');
  if (equals != parameter.npos) {
    const char* expression = kept(parameter.substr(equals + 1));
    const py::arg_v optional(kept(parameter.substr(0, equals)), value_of(expression), expression);
    return process_attribute<py::arg_v>::init(optional, function);
  }
  const bool none = !parameter.ends_with(kNotNone);
  if (!none) parameter.remove_suffix(kNotNone.size());
  process_attribute<py::arg>::init(py::arg(kept(parameter)).none(none), function);
}

}  // namespace

const Text& text_of(const std::string& key) {
  const auto found = std::ranges::equal_range(texts(), std::string_view(key), {}, &Text::key);
  if (found.empty()) {
    if (key.find(".__") != key.npos) return kNone;
    throw std::logic_error("docs/*.txt have no entry for " + key);
  }
  return found[taken[key]++ % found.size()];
}

void expect_all_texts_taken() {
  for (const Text& text : texts())
    if (!taken.contains(text.key))
      throw std::logic_error(std::string("docs/*.txt describe ") + text.key + ", which does not exist");
}

std::string name_in(const char* function) {
  std::string_view text = function;
  text.remove_prefix(text.find("V = ") + 4);
  text = text.substr(0, text.find_first_of(";]"));  // the value of V, such as "&Base<A, B>::nu" or "Handle<Joint>"
  text = text.substr(0, text.find_last_not_of('>') + 1);
  return text.front() == '(' ? "" : std::string(text.substr(text.rfind(':') + 1));
}

std::string plain(std::string name) {
  for (char& c : name) c = c == '_' || c == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

std::string python_name(const std::string& enumerator) {
  if (enumerator.front() != 'k') return enumerator;
  std::string name;
  for (std::size_t i = 1; i < enumerator.size(); ++i) {
    const auto c = static_cast<unsigned char>(enumerator[i]);
    if (i > 1 && std::isupper(c) && !std::isdigit(static_cast<unsigned char>(enumerator[i - 1]))) name += '_';
    name += static_cast<char>(std::toupper(c));
  }
  return name;
}

void set_names_of_defaults(const py::module_& m) { names_of_defaults = m.attr("__dict__").ptr(); }

void describe(const Text& text, py::detail::function_record* function) {
  const std::string_view all = text.parameters;
  for (std::size_t start = 0; start < all.size();) {
    const std::size_t end = std::min(all.find('\n', start), all.size());
    add_parameter(all.substr(start, end - start), function);
    start = end + 1;
  }
  if (*text.doc) function->doc = const_cast<char*>(text.doc);
}

}  // namespace manycontact::python
