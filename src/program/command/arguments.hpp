#pragma once
// The command line after the command's name: options and operands.

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace manycontact::cli {

/// The command line is not what the command expects.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An option a command knows.
struct Option {
  std::string name;   // the name with its dashes
  std::string value;  // the placeholder of its value in the usage, empty for a flag
  std::string help;
  bool required = false;  // shown in the usage; the command itself refuses to run without it
};

class Arguments {
 public:
  /// Sorts `words`: "--name value" or "--name=value" for the options given, "--" ends them. Throws UsageError.
  Arguments(const std::vector<Option>& options, const std::vector<std::string>& words);

  bool has(const std::string& option) const { return value(option).has_value(); }
  /// The value of the option, empty for a flag; none when it was not given.
  std::optional<std::string> value(const std::string& option) const;
  /// The value; throws UsageError when it was not given.
  std::string required(const std::string& option) const;
  /// The value as a whole number from `least` to `most`, `otherwise` when it was not given. Throws UsageError.
  int integer(const std::string& option, int least, int most, int otherwise) const;
  /// The value as a finite number above 0, `otherwise` when it was not given. Throws UsageError, also when it was not
  /// given and there is no `otherwise`.
  double positive(const std::string& option, std::optional<double> otherwise = {}) const;
  const std::vector<std::string>& rest() const { return rest_; }

 private:
  std::vector<std::pair<std::string, std::string>> given_;
  std::vector<std::string> rest_;
};

}  // namespace manycontact::cli
