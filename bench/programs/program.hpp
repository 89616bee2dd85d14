#pragma once
// What is compared: manycontact and its peers, each a source file here and a benchmark program of its own.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../scenes.hpp"

namespace manycontact::bench {

/// A scene in a program's own terms, at its state.
struct Loaded {
  virtual ~Loaded() = default;
  /// What run starts from, each time anew; not timed.
  virtual void begin() {}
  virtual void run() = 0;
  /// Accelerations in manycontact's coordinates, after run; empty where the task has none.
  virtual Eigen::VectorXd accelerations() { return {}; }
};

struct Program {
  std::string name, version;
  std::vector<std::string> tasks;
  /// Of one robot, without its contacts: of rnea, aba, crba, frame_jacobian those that it has.
  std::vector<std::string> of_bodies;
  /// Empty, or why this program does not do this.
  std::string (*refuses)(const Posed& scene, const std::string& task);
  /// A task may have dials, numbers after its name: "constrainedABA:1e-6:5".
  std::unique_ptr<Loaded> (*load)(const Posed& scene, const std::string& task);
};

struct Task {
  std::string name;
  std::vector<double> dials;
};
Task task_of(const std::string& words);

/// Runs the task of settings() on its scene: the accelerations, a number a line in manycontact's coordinates, go to
/// settings().out, and the median time of a run [us] to standard output. Throws std::runtime_error where the program does
/// not do this.
void run_on_scene();

/// The one this executable is for.
const Program& program();

}  // namespace manycontact::bench
