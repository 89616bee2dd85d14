#include "command.hpp"

#include <filesystem>
#include <sstream>

#include "output_file.hpp"
#include "table.hpp"

namespace manycontact::cli {

std::string scene_operand(const Arguments& arguments, const std::string& name) {
  if (arguments.rest().empty()) throw UsageError(name + " is missing");
  if (arguments.rest().size() > 1)
    throw UsageError("one " + name + " is expected, '" + arguments.rest()[1] + "' is a second");
  return arguments.rest()[0];
}

void check_writable(const std::string& path, const std::string& option) {
  PartFile file(path, option);
  if (!file.is_straight()) file.create();  // a pipe may wait when it is opened, and ends when it is closed
}

void check_files(const Arguments& arguments, const std::vector<std::string>& read,
                 const std::vector<std::string>& written) {
  namespace fs = std::filesystem;
  const auto one_file = [](const std::string& a, const std::string& b) {
    std::error_code error;
    const fs::path at = fs::weakly_canonical(a, error), other = fs::weakly_canonical(b, error);
    if (a == "-" || b == "-" || error) return false;
    const bool there = fs::exists(at, error);
    return !there || !fs::exists(other, error) ? at == other
                                               : fs::is_regular_file(at, error) && fs::equivalent(at, other, error);
  };
  // What is written is called FILE.part at first.
  const auto meets = [&one_file](const std::string& file, const std::string& other) {
    return one_file(file, other) || (file != "-" && one_file(file + ".part", other));
  };
  for (std::size_t k = 0; k < written.size(); ++k) {
    const auto file = arguments.value(written[k]);
    if (!file) continue;
    for (const std::string& input : read)
      if (meets(*file, input)) throw UsageError(written[k] + " would be written over '" + input + "', which is read");
    for (std::size_t j = 0; j < k; ++j) {
      const auto other = arguments.value(written[j]);
      if (other && *file == "-" && *other == "-")
        throw UsageError(written[j] + " and " + written[k] + " are both standard output");
      if (other && (meets(*file, *other) || meets(*other, *file)))
        throw UsageError(written[j] + " and " + written[k] + " are one file, expected two");
    }
  }
}

std::string usage(const Command& command) {
  std::string text = "usage: manycontact " + command.name + " " + command.operands;
  for (const Option& option : command.options) {
    const std::string word = option.name + (option.value.empty() ? "" : " " + option.value);
    text += option.required ? " " + word : " [" + word + "]";
  }
  return text;
}

std::string help(const Command& command) {
  std::ostringstream out;
  out << usage(command) << "\n\n";
  wrap(out, command.summary, 0);
  if (!command.options.empty()) {
    out << "\n";
    Table table({{"", Table::kLeft}, {"", Table::kLeft}});
    for (const Option& option : command.options) table.add({option.name + " " + option.value, option.help});
    table.print(out);
  }
  if (!command.help.empty()) out << "\n" << command.help;
  return out.str();
}

}  // namespace manycontact::cli
