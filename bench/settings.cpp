#include "settings.hpp"

#include <sstream>
#include <stdexcept>

namespace manycontact::bench {

namespace {

std::vector<std::string> two_names(const std::string& option, const std::string& text) {
  std::vector<std::string> names;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  if (names.size() != 2 || names[0] == names[1])
    throw std::invalid_argument(option + " " + text + ": expected two frames, as left_sole,right_sole");
  return names;
}

std::vector<void (*)()>& registrations() {
  static std::vector<void (*)()> all;
  return all;
}

}  // namespace

Settings parse(int& argc, char** argv) {
  Settings s;
  int kept = 1;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const auto value = [&] {
      if (k + 1 >= argc) throw std::invalid_argument(word + ": its value is missing");
      return std::string(argv[++k]);
    };
    if (word == "--robot")
      s.robot = value();
    else if (word == "--feet")
      s.feet = two_names(word, value());
    else if (word == "--hands")
      s.hands = two_names(word, value());
    else if (word == "--out")
      s.out = value();
    else if (word == "--scene")
      s.scene = value();
    else if (word == "--task")
      s.task = value();
    else if (word == "--quick")
      s.quick = true;
    else
      argv[kept++] = argv[k];
  }
  argc = kept;
  return s;
}

Settings& settings() {
  static Settings given;
  return given;
}

Registration::Registration(void (*add)()) { registrations().push_back(add); }

void register_all() {
  for (const auto add : registrations()) add();
}

}  // namespace manycontact::bench
