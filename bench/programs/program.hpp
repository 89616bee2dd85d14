#pragma once
// The interface of manycontact and its peers; each is a source file here and a benchmark program of its own.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../scenes.hpp"

namespace manycontact::bench {

/// A scene as a program's own model, at its state.
struct Loaded {
  virtual ~Loaded() = default;
  /// Restores the state that run starts from; called before each run, not timed.
  virtual void begin() {}
  virtual void run() = 0;
  /// Returns accelerations in manycontact's coordinates, after run; empty if the task has none.
  virtual Eigen::VectorXd accelerations() { return {}; }
};

struct Program {
  std::string name, version;
  std::vector<std::string> tasks;
  /// Tasks of one robot that the program has: rnea, aba, crba, frame_jacobian, without contacts, and FDDP.
  std::vector<std::string> of_one;
  /// Returns why this program does not support this, or nothing.
  std::string (*refuses)(const Posed& scene, const std::string& task);
  /// A task may have dials, numbers after its name: "constrainedABA:1e-6:5".
  std::unique_ptr<Loaded> (*load)(const Posed& scene, const std::string& task);
};

struct Task {
  std::string name;
  std::vector<double> dials;
};
Task task_of(const std::string& words);

/// Runs the task of settings() on its scene. Writes the accelerations, one number per line in our coordinates, to
/// settings().out, and the median time [us] to standard output. Throws std::runtime_error if this is not supported.
void run_on_scene();

/// Returns the program of this executable.
const Program& program();

}  // namespace manycontact::bench
