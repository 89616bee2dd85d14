#include "command.hpp"

#include <fstream>
#include <sstream>

#include "manycontact/io/input_error.hpp"
#include "table.hpp"

namespace manycontact::cli {

std::string scene_operand(const Arguments& arguments, const std::string& name) {
  if (arguments.rest().empty()) throw UsageError(name + " is missing");
  if (arguments.rest().size() > 1)
    throw UsageError("one " + name + " is expected, '" + arguments.rest()[1] + "' is a second");
  return arguments.rest()[0];
}

void check_writable(const std::string& path, const std::string& option) {
  if (path != "-" && !std::ofstream(path, std::ios::app))
    throw InputError(path, 1, "cannot be written, expected a file that " + option + " may create");
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
