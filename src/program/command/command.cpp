#include "command.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "../files/output_file.hpp"
#include "../text/table.hpp"
#include "manycontact/io/input_error.hpp"

namespace manycontact::cli {

namespace {

namespace fs = std::filesystem;

// Returns the absolute path with symbolic links resolved, even if there is no such file. Hard links to one file remain
// different paths, because an output file replaces only the link that it names.
fs::path place_of(const std::string& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error), place = fs::weakly_canonical(absolute, error);
  return error ? absolute.lexically_normal() : place;
}

// Returns whether both names are one regular file. Devices and pipes accept output of several writers and never count.
bool one_file(const std::string& a, const std::string& b) {
  return !is_written_straight(a) && b != "-" && place_of(a) == place_of(b);
}

}  // namespace

std::string scene_operand(const Arguments& arguments, const std::string& name) {
  if (arguments.rest().empty()) throw UsageError(name + " is missing");
  if (arguments.rest().size() > 1)
    throw UsageError("'" + arguments.rest()[1] + "' is a second " + name + ", exactly one " + name + " is expected");
  return arguments.rest()[0];
}

void check_writable(const std::string& path, const std::string& option) {
  // Pipes are left out: opening one may block, and closing it would end the connection.
  if (!is_written_straight(path)) OutputFile(path, option);
}

void check_unread(const std::string& option, const std::string& file, const std::vector<std::string>& read) {
  for (const std::string& input : read)
    if (one_file(file, input))
      throw UsageError(option + " would overwrite the input '" + input + "': choose another file");
}

void check_files(const Arguments& arguments, const std::vector<std::string>& read,
                 const std::vector<std::string>& written) {
  for (std::size_t k = 0; k < written.size(); ++k) {
    const auto file = arguments.value(written[k]);
    if (!file) continue;
    check_unread(written[k], *file, read);
    for (std::size_t j = 0; j < k; ++j) {
      const auto other = arguments.value(written[j]);
      if (other && is_standard_output(*file) && is_standard_output(*other))
        throw UsageError(written[j] + " and " + written[k] +
                         " are both standard output: choose a file for one of them");
      if (other && one_file(*file, *other))
        throw UsageError(written[j] + " and " + written[k] + " are the same file, expected two files");
    }
  }
}

void check_folder(const std::string& option, const std::string& folder, const std::vector<std::string>& names,
                  const std::vector<std::string>& others) {
  for (const std::string& name : names) {
    const std::string file = (fs::path(folder) / name).string();
    for (const std::string& other : others)
      if (one_file(file, other))
        throw UsageError(option + " would overwrite '" + other + "' with '" + file + "': choose another folder");
  }
}

void make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder))
    throw InputError(folder, 1, "cannot be created as a folder, expected a folder for --out");
}

bool is_standard_output(const Arguments& arguments, const std::vector<std::string>& written) {
  return std::ranges::any_of(written, [&](const std::string& option) {
    const auto file = arguments.value(option);
    return file && is_standard_output(*file);
  });
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
    Table table("<|<");
    for (const Option& option : command.options) table.add({option.name + " " + option.value, option.help});
    table.print(out);
  }
  if (!command.help.empty()) out << "\n" << command.help;
  return out.str();
}

}  // namespace manycontact::cli
