#include "../text/table.hpp"
#include "command.hpp"

namespace manycontact::cli {

namespace {

template <class Values>
std::string names_of(const Values& values) {
  std::vector<std::string> names;
  for (const auto& value : values) names.push_back(to_string(value));
  return join(names, 20);
}

// Returns the value that an option names, or nullopt if the option was not given.
template <class Value, std::size_t n>
std::optional<Value> chosen(const Arguments& arguments, const std::string& what, const Value (&values)[n]) {
  const auto name = arguments.value("--" + what);
  if (!name) return std::nullopt;
  for (const Value& value : values)
    if (to_string(value) == *name) return value;
  throw UsageError("unknown " + what + " '" + *name + "', expected one of " + names_of(values));
}

}  // namespace

std::string with_names(std::string text) {
  for (const auto& [name, values] :
       {std::pair("{methods}", names_of(kMethods)), std::pair("{orders}", names_of(kOrders)),
        std::pair("{precisions}", names_of(kPrecisions))})
    for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos;)
      text.replace(at, std::string_view(name).size(), values);
  return text;
}

Options solver_options(const Arguments& arguments) {
  Options options;
  options.method = chosen(arguments, "method", kMethods).value_or(options.method);
  options.order = chosen(arguments, "order", kOrders);
  if (options.order && !has_order(options.method) && options.method != Method::kAuto)
    throw UsageError("method " + to_string(options.method) + " has no elimination order: omit --order");
  options.precision = chosen(arguments, "precision", kPrecisions).value_or(options.precision);
  return options;
}

}  // namespace manycontact::cli
