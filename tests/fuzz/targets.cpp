#include "targets.hpp"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "answers.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/io/task_file.hpp"
#include "manycontact/io/urdf.hpp"
#include "scene_of_bytes.hpp"

namespace manycontact::fuzz {

namespace {

namespace fs = std::filesystem;

// A folder of this process with the files that are referred to; it is removed at the end.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("manycontact_fuzz_" + std::to_string(getpid()))) {
    fs::create_directories(path_);
    for (const char* robot : {"arm.urdf", "box.urdf", "quadruped.urdf"})
      fs::copy_file(fs::path(MANYCONTACT_SOURCE_DIR) / "models" / robot, path_ / robot,
                    fs::copy_options::overwrite_existing);
    (void)write("scene.xml",
                R"(<scene><robot name="quadruped" urdf="quadruped.urdf" base="floating" xyz="0 0 0.5"/>
                   <contact name="LF" type="3d" frame="quadruped/LF_foot"/>
                   <contact name="RH" type="6d" frame="quadruped/RH_foot"/></scene>)");
    (void)write(
        "herd.xml",
        R"(<scene><robot name="herd" urdf="arm.urdf" copies="3"/><robot name="box" urdf="box.urdf" base="floating"/>
                   <contact name="tool" type="6d" frame="herd/tool"/></scene>)");
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

  std::string write(const char* name, const std::string& text) const {
    const fs::path path = path_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path.string();
  }

 private:
  fs::path path_;
};

const Folder& folder() {
  static const Folder f;
  return f;
}

std::string text_of(const std::uint8_t* data, std::size_t size) { return std::string(data, data + size); }

void check(bool holds, const char* what) {
  if (!holds) throw Finding(what);
}

// Expects "FILE:LINE: message" on one line that a terminal can show.
void check_message(const InputError& error) {
  const std::string what = error.what();
  check(error.line >= 1 && !error.message.empty(), "a refusal without a line or a message");
  for (const char c : what) check(static_cast<unsigned char>(c) >= ' ', "a refusal of more than one line");
  check(what.size() < 2000, "a refusal longer than a screen");
}

void check_scene(const SceneFile& file) {
  const Scene& scene = file.scene;
  check(file.q.size() == scene.nq && file.v.size() == scene.nv && file.u.size() == scene.nu, "sizes of q, v, u");
  check(file.q.allFinite() && file.v.allFinite(), "q or v is not finite");
  check(file.robot_group.size() == scene.robots.size() && file.moved.size() == scene.robots.size(), "robots");
  for (const Contact& c : scene.contacts)
    check(c.A.placement.p.allFinite() && c.B.placement.p.allFinite() && c.B.placement.R.allFinite(), "a placement");
}

constexpr int kMostSolved = 120;  // more take too long for a fuzzer

// Returns the number of unknowns and robots.
int effort(const Scene& scene) {
  int n = scene.nv + scene.nrobots();
  for (const Contact& c : scene.contacts) n += c.rows();
  return n;
}

}  // namespace

void fuzz_urdf(const std::uint8_t* data, std::size_t size) {
  const std::string path = folder().write("fuzzed.urdf", text_of(data, size));
  for (const bool floating : {false, true}) try {
      Scene scene;
      (void)add_robot(scene, "r", std::make_shared<const Model>(load_urdf(path, {.floating_base = floating})));
      if (effort(scene) > kMostSolved) continue;
      const Eigen::VectorXd q = neutral(*scene.robots[0].model);
      check_answers(scene, q, Eigen::VectorXd::Constant(scene.nv, 0.1), Eigen::VectorXd::Zero(scene.nu));
    } catch (const InputError& error) {
      check_message(error);
    }
}

void fuzz_scene(const std::uint8_t* data, std::size_t size) {
  const std::string path = folder().write("fuzzed.xml", text_of(data, size));
  try {
    const SceneFile file = read_scene(path);
    check_scene(file);
    if (effort(file.scene) > kMostSolved) return;
    const SceneFile loaded = load_scene(path);
    check_answers(loaded.scene, loaded.q, loaded.v, loaded.u);
  } catch (const InputError& error) {
    check_message(error);
  }
}

void fuzz_task(const std::uint8_t* data, std::size_t size) {
  const std::string path = folder().write("task.xml", text_of(data, size));
  try {
    const TaskFile task = read_task(path);
    check_scene(task.scene);
    check(task.step > 0 && std::isfinite(task.step) && task.nodes() > 0, "a step or a number of nodes");
    const auto check_terms = [&](const std::vector<TaskTerm>& terms, bool costs) {
      for (const TaskTerm& t : terms) {
        check(t.nr >= 0 && (t.weights.size() == 0 || t.weights.size() == t.nr), "weights");
        check(t.lower.size() == t.upper.size() && (t.lower.size() == 0 || t.lower.size() == t.nr), "bounds");
        check(t.reference.allFinite() && t.placement.p.allFinite() && t.weight >= 0, "numbers");
        check(costs || t.weights.size() == 0, "weights of a constraint");
      }
    };
    for (const TaskPhase& phase : task.phases) check_terms(phase.costs, true), check_terms(phase.constraints, false);
    check_terms(task.terminal.costs, true), check_terms(task.terminal.constraints, false);
  } catch (const InputError& error) {
    check_message(error);
  }
}

void fuzz_solve(const std::uint8_t* data, std::size_t size) {
  const MadeScene made = scene_of_bytes(data, size);
  check_answers(made.scene, made.q, made.v, made.u);
}

}  // namespace manycontact::fuzz
