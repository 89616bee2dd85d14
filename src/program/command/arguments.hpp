#pragma once
// Parses the words of the command line that follow the command: options and operands.

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace manycontact::cli {

struct UsageError : std::runtime_error {  // the exception for a command line that differs from what the command expects
  using std::runtime_error::runtime_error;
};

struct Option {
  std::string name;   // the name of the option with its dashes
  std::string value;  // the placeholder of its value in the usage; empty for a flag
  std::string help;
  bool required = false;  // whether the usage shows the option as required; the command itself throws if it is missing
};

class Arguments {
 public:
  /// Parses `words`. Options are written "--name value" or "--name=value", and "--" ends them. Throws UsageError.
  Arguments(const std::vector<Option>& options, const std::vector<std::string>& words);

  bool has(const std::string& option) const { return value(option).has_value(); }
  /// Returns the value of an option, empty for a flag, or nullopt if the option was not given.
  std::optional<std::string> value(const std::string& option) const;
  /// Returns the value of an option. Throws UsageError if the option was not given.
  std::string required(const std::string& option) const;
  /// Returns the value as a whole number from `least` to `most`, or `otherwise` if it was not given. Throws UsageError.
  int integer(const std::string& option, int least, int most, int otherwise) const;
  /// Returns the value as a finite number above 0, or `otherwise` if the option was not given. Throws UsageError for
  /// other values, and if neither is given.
  double positive(const std::string& option, std::optional<double> otherwise = {}) const;
  const std::vector<std::string>& rest() const { return rest_; }

 private:
  std::vector<std::pair<std::string, std::string>> given_;
  std::vector<std::string> rest_;
};

}  // namespace manycontact::cli
