#pragma once
// The command line after the command's name: options and operands.

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace manycontact::cli {

/// Thrown if the command line is not what the command expects.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Option {
  std::string name;   // the name with its dashes
  std::string value;  // the placeholder of the option's value in the usage; empty for a flag
  std::string help;
  bool required = false;  // shown in the usage; the command itself refuses to run without it
};

class Arguments {
 public:
  /// Parses `words`: "--name value" or "--name=value" for `options`; "--" ends the options. Throws UsageError.
  Arguments(const std::vector<Option>& options, const std::vector<std::string>& words);

  bool has(const std::string& option) const { return value(option).has_value(); }
  /// Returns the option's value, empty for a flag; none if it was not given.
  std::optional<std::string> value(const std::string& option) const;
  /// Returns the option's value; throws UsageError if it was not given.
  std::string required(const std::string& option) const;
  /// Returns the value as a whole number from `least` to `most`, or `otherwise` if not given. Throws UsageError.
  int integer(const std::string& option, int least, int most, int otherwise) const;
  /// Returns the value as a finite number above 0, or `otherwise`. Throws UsageError, also if neither is given.
  double positive(const std::string& option, std::optional<double> otherwise = {}) const;
  const std::vector<std::string>& rest() const { return rest_; }

 private:
  std::vector<std::pair<std::string, std::string>> given_;
  std::vector<std::string> rest_;
};

}  // namespace manycontact::cli
