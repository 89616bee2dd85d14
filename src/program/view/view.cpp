#include "view.hpp"

#include <filesystem>
#include <iostream>

#include "../text/table.hpp"
#include "manycontact/analysis/load_scene.hpp"

namespace manycontact::cli {

namespace {

constexpr double kMostRate = 1000;  // largest number of frames per second

void print_written(std::ostream& out, const std::string& path, const Recording& recording,
                   const std::vector<std::string>& notes) {
  std::error_code error;
  const auto bytes = static_cast<double>(std::filesystem::file_size(path, error));
  out << printable(path) << ": " << count(recording.t.size(), "frame") << ", " << decimal(bytes / 1e6, 1) << " MB\n";
  for (const std::string& note : notes) wrap(out, printable(note), 2);
}

}  // namespace

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

int run_view(const Arguments& arguments) {
  const std::string path = scene_operand(arguments);
  const auto trajectory = arguments.value("--trajectory"), forces = arguments.value("--forces");
  if (forces && !trajectory) throw UsageError("--forces needs --trajectory, which is missing");
  const double rate = arguments.positive("--rate", 50), friction = arguments.positive("--friction", 1e-300);
  if (rate > kMostRate) throw UsageError("--rate is above 1000 frames per second, expected at most 1000");
  const std::string out = arguments.required("--out");
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
  const std::vector<std::string> notes = write_view(file, recording, out);
  if (!is_standard_output(arguments, {"--out"})) print_written(std::cout, out, recording, notes);
  return kExitOk;
}

}  // namespace manycontact::cli
