#include "arguments.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace manycontact::cli {

Arguments::Arguments(const std::vector<Option>& options, const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--") {
      rest_.insert(rest_.end(), words.begin() + static_cast<std::ptrdiff_t>(i) + 1, words.end());
      break;
    }
    if (word.size() < 2 || word[0] != '-') {
      rest_.push_back(word);
      continue;
    }
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const auto option = std::ranges::find(options, name, &Option::name);
    if (option == options.end()) throw UsageError("unknown option '" + name + "'");
    if (has(name)) throw UsageError("option " + name + " is given twice");
    const bool inside = equals != std::string::npos;
    std::string value = inside ? word.substr(equals + 1) : "";
    if (option->value.empty() && inside) throw UsageError("option " + name + " takes no value");
    if (!option->value.empty() && !inside) {
      if (i + 1 == words.size()) throw UsageError("option " + name + " needs a value " + option->value);
      value = words[++i];
    }
    if (!option->value.empty() && value.empty())
      throw UsageError("option " + name + " has an empty value, expected " + option->value);
    given_.emplace_back(name, value);
  }
}

std::optional<std::string> Arguments::value(const std::string& option) const {
  for (const auto& [name, value] : given_)
    if (name == option) return value;
  return std::nullopt;
}

std::string Arguments::required(const std::string& option) const {
  const std::optional<std::string> text = value(option);
  if (!text) throw UsageError("option " + option + " is missing");
  return *text;
}

int Arguments::integer(const std::string& option, int least, int most, int otherwise) const {
  const std::optional<std::string> text = value(option);
  if (!text) return otherwise;
  int number = 0;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), number);
  if (error != std::errc() || end != text->data() + text->size() || number < least || number > most)
    throw UsageError("option " + option + " is '" + *text + "', expected a whole number from " + std::to_string(least) +
                     " to " + std::to_string(most));
  return number;
}

double Arguments::positive(const std::string& option, std::optional<double> otherwise) const {
  const std::optional<std::string> text = value(option);
  if (!text && otherwise) return *otherwise;
  const std::string given = required(option);
  double number = 0;
  const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), number);
  if (error != std::errc() || end != given.data() + given.size() || !std::isfinite(number) || number <= 0)
    throw UsageError("option " + option + " is '" + given + "', expected a number above 0");
  return number;
}

}  // namespace manycontact::cli
