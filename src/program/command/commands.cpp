#include <sstream>

#include "command.hpp"

namespace manycontact::cli {

namespace {

// Parses a line of commands.txt such as "--out FILE (required): where it goes".
Option option_of(const std::string& line) {
  const std::string required = " (required)";
  const std::size_t colon = line.find(": ");
  std::string word = line.substr(0, colon);
  Option out;
  out.help = line.substr(colon + 2);
  out.required = word.ends_with(required);
  if (out.required) word.resize(word.size() - required.size());
  const std::size_t blank = std::min(word.find(' '), word.size());
  out.name = word.substr(0, blank);
  out.value = word.substr(std::min(blank + 1, word.size()));
  return out;
}

}  // namespace

Command command(const std::string& name, int (*run)(const Arguments&)) {
  std::istringstream text(with_names(std::string(commands_text())));
  const std::string title = "=== " + name + " ", in = " in ";
  Command out;
  std::string line;
  while (std::getline(text, line) && !line.starts_with(title)) continue;
  line.erase(0, title.size());
  const std::size_t end = std::min(line.find(in), line.size());
  out.name = name;
  out.operands = line.substr(0, end);
  out.beside = line.substr(std::min(end + in.size(), line.size()));
  out.run = run;
  std::getline(text, out.summary);
  while (std::getline(text, line) && !line.starts_with("==="))
    if (line.starts_with("--"))
      out.options.push_back(option_of(line));
    else
      out.help += line + "\n";
  return out;
}

}  // namespace manycontact::cli
