#include "manycontact/analysis/text.hpp"

namespace manycontact::text {

std::string count(long n, const std::string& noun) {
  return std::to_string(n) + " " +
         (n == 1                ? noun
          : noun.ends_with('y') ? noun.substr(0, noun.size() - 1) + "ies"
                                : noun + "s");
}

std::string join(const std::vector<std::string>& names, std::size_t most) {
  const std::size_t shown = names.size() <= most + 1 ? names.size() : most;
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) text += (i ? ", " : "") + names[i];
  if (shown < names.size()) text += " and " + std::to_string(names.size() - shown) + " more";
  return text;
}

}  // namespace manycontact::text
