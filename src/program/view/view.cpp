#include "view.hpp"

#include <filesystem>
#include <iostream>

#include "../text/table.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "trajectory_file.hpp"

namespace manycontact::cli {

namespace {

constexpr double kMostRate = 1000;  // Hz

void print_written(std::ostream& out, const std::string& path, const Recording& recording,
                   const std::vector<std::string>& notes) {
  std::error_code error;
  const auto bytes = static_cast<double>(std::filesystem::file_size(path, error));
  out << printable(path) << ": " << count(static_cast<long>(recording.t.size()), "frame") << ", "
      << decimal(bytes / 1e6, 1) << " MB\n";
  for (const std::string& note : notes) wrap(out, printable(note), 2);
}

int run_view(const Arguments& arguments) {
  const std::string path = scene_operand(arguments);
  const auto trajectory = arguments.value("--trajectory"), forces = arguments.value("--forces");
  if (forces && !trajectory) throw UsageError("--forces is given without --trajectory");
  const double rate = arguments.positive("--rate", 50), friction = arguments.positive("--friction", 1e-300);
  if (rate > kMostRate) throw UsageError("--rate is more than 1000 frames per second");
  const auto out = arguments.value("--out");
  if (!out) throw UsageError("option --out is missing");
  check_files(arguments, {path, trajectory.value_or("-"), forces.value_or("-")}, {"--out"});

  const SceneFile file = trajectory ? read_scene(path) : load_scene(path);
  check_files(arguments, file.files, {"--out"});
  Recording recording(file.scene, rate);
  if (arguments.has("--friction"))
    for (std::size_t c = 0; c < recording.friction.size(); ++c)
      if (file.scene.contacts[c].B.robot < 0) recording.friction[c] = friction;
  if (trajectory) {
    read_trajectory(*trajectory, forces, file.scene, recording);
  } else {
    add_state({0, file.q, file.v, recording.dynamics.active, file.u}, recording);
  }
  const std::vector<std::string> notes = write_view(file, recording, *out);
  if (!is_standard_output(arguments, {"--out"})) print_written(std::cout, *out, recording, notes);
  return kExitOk;
}

}  // namespace

Option view_option() { return {"--view", "FILE", "one HTML page that shows the motion, as `view` writes"}; }

std::optional<Recording> recording_of(const Arguments& arguments, const Scene& scene) {
  const auto path = arguments.value("--view");
  if (!path) return std::nullopt;
  if (is_standard_output(arguments, {"--view"})) throw UsageError("--view is standard output, expected a file");
  std::optional<Recording> recording(std::in_place, scene);
  check_writable(*path, "--view");
  return recording;
}

void finish_view(const Arguments& arguments, const SceneFile& file, std::optional<Recording>& recording,
                 std::ostream* out) {
  if (!recording) return;
  const std::string path = *arguments.value("--view");
  const std::vector<std::string> notes = write_view(file, *recording, path);
  if (out) print_written(*out, path, *recording, notes);
}

const Command& view_command() {
  static const Command command{
      "view",
      "SCENE",
      "The scene as a page for a browser: robots, contacts, their forces, islands; with a trajectory, through time.",
      {{"--out", "FILE", "HTML, one file that needs no network; - is standard output", true},
       {"--trajectory", "FILE", "CSV in the columns of `simulate`; default: the scene's state, with the forces there"},
       {"--forces", "FILE", "CSV: the forces at states of the trajectory, t and f:left[0] ...; 0: not active"},
       {"--rate", "HZ", "frames per second at most (50)"},
       {"--friction", "MU", "draws cones at contacts with the world, about their normals"}},
      "Forces are arrows; a trajectory has none without --forces. Contacts are marked, redundant ones with a ring;\n"
      "forces that contacts could share otherwise are pale.\n"
      "Meshes are read in STL, OBJ and COLLADA (.dae), if assimp was there when this program was built; package:// is\n"
      "looked for in the folders above the URDF and in ROS_PACKAGE_PATH.\n"
      "Exit status: 0 written; 1 three.js was not there when this program was built; 2 bad usage, bad input or "
      "output.\n",
      run_view};
  return command;
}

}  // namespace manycontact::cli
