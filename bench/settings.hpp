#pragma once

#include <string>
#include <vector>

namespace manycontact::bench {

struct Settings {
  std::string robot;               // URDF file; empty: models/humanoid.urdf
  std::vector<std::string> feet;   // two frames fixed to the world; empty: the lowest of the left and of the right
  std::vector<std::string> hands;  // two frames by which a ring is closed; empty: farthest to the left and to the right
  bool quick = false;              // fewer sizes, shorter
  std::string out;                 // JSON file of the results; empty: none
  std::string scene, task;         // one scene's file and the task on it, with its dials; empty: the benchmarks
};

/// Removes our options (--robot, --feet, --hands, --quick, ...) from argv. Throws std::invalid_argument.
Settings parse(int& argc, char** argv);

Settings& settings();

/// Registers benchmarks after the command line was read.
struct Registration {
  explicit Registration(void (*add)());
};
void register_all();

}  // namespace manycontact::bench
