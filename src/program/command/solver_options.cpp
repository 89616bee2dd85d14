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
  if (const auto name = arguments.value("--method")) {
    const auto method = method_from_string(*name);
    if (!method) throw UsageError("unknown method '" + *name + "', expected one of " + names_of(kMethods));
    options.method = *method;
  }
  if (const auto name = arguments.value("--order")) {
    options.order = order_from_string(*name);
    if (!options.order) throw UsageError("unknown order '" + *name + "', expected one of " + names_of(kOrders));
    if (!has_order(options.method) && options.method != Method::kAuto)
      throw UsageError("method " + to_string(options.method) + " has no order to choose");
  }
  if (const auto name = arguments.value("--precision")) {
    const auto precision = precision_from_string(*name);
    if (!precision) throw UsageError("unknown precision '" + *name + "', expected one of " + names_of(kPrecisions));
    options.precision = *precision;
  }
  return options;
}

}  // namespace manycontact::cli
