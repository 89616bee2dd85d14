#include "manycontact/analysis/text.hpp"

#include <cmath>
#include <cstdio>

namespace manycontact::text {

std::string count(long n, const std::string& noun) {
  return std::to_string(n) + " " +
         (n == 1                ? noun
          : noun.ends_with('y') ? noun.substr(0, noun.size() - 1) + "ies"
                                : noun + "s");
}

std::string join(const std::vector<std::string>& names, std::size_t most, const std::string& between,
                 const std::string& before_rest) {
  const std::size_t shown = names.size() <= most + 1 ? names.size() : most;
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) text += (i ? between : "") + names[i];
  if (shown < names.size()) text += before_rest + std::to_string(names.size() - shown) + " more";
  return text;
}

std::string number(double x, int digits) {
  if (std::isnan(x)) return "nan";
  const bool whole = std::abs(x) >= std::pow(10.0, digits) - 0.5 && std::abs(x) < 1e7;  // no exponent as in 1.2e+04
  char text[400];
  std::snprintf(text, sizeof text, whole ? "%.*f" : "%.*g", whole ? 0 : digits, x == 0 ? 0.0 : x);
  return text;
}

std::string two_sizes(double first, const char* unit, double second, const char* unit_of_second, double negligible) {
  std::string text;
  if (first >= negligible) text = number(first) + " " + unit;
  if (second >= negligible) text += (text.empty() ? "" : " and ") + number(second) + " " + unit_of_second;
  return text;
}

}  // namespace manycontact::text
