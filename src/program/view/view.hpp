#pragma once
// Common parts of `manycontact view`, `simulate --view` and `optimize --view`: a motion recorded frame by frame, and
// the page that shows it.

#include <optional>

#include "../command/command.hpp"
#include "manycontact/detail/simulation/invariants.hpp"
#include "manycontact/dynamics/data.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

/// A state on the way. Forces come from a solve with the torques u, or they are given; with neither none are shown.
struct ViewState {
  double t = 0;  // s
  Eigen::VectorXd q, v;
  std::vector<char> active;                                 // one flag per contact
  std::optional<Eigen::VectorXd> u = {};                    // torques of this state
  std::optional<std::vector<Eigen::VectorXd>> forces = {};  // one entry per contact, in its reference frame
  std::optional<Eigen::Vector2d> drift = {};                // position, velocity; default: those of `active`
  std::optional<std::vector<Vec6<double>>> wrenches = {};   // wrenches; default: the scene's
};

/// The data that the page draws, one frame after the other.
struct Recording {
  /// Records at most `rate` frames per second. The scene outlives the recording. Throws std::runtime_error if the build
  /// cannot make pages.
  explicit Recording(const Scene& scene, double rate = 50);

  const Scene* scene;
  double rate;
  std::vector<double> friction;  // one entry per contact: coefficient of the cone drawn, the contact's mu; 0: none

  // These members have entries for each frame.
  std::vector<double> t;                              // s
  std::vector<float> kinetic, potential;              // J
  std::vector<float> violation_position, violation_velocity;  // m or rad, and per s
  std::vector<float> positions;                       // 3 per body, m: bodies of all robots, in their order
  std::vector<std::int16_t> quaternions;              // 4 per body, x y z w times 32767
  std::vector<std::int32_t> islands;                  // one per robot: the first robot of its island
  std::vector<float> points, normals, forces;         // 3 per contact, in the world: A's origin, the contact's
                                                      // normal, the force on A [N], NaN: unknown
  std::vector<float> held;                            // 6 per contact: B' and the frame it was attached by
  std::vector<float> wrenches, springs;               // 6 per external wrench, in the world: point of application,
                                                      // force [N]; 6 per spring: its ends
  std::vector<std::uint8_t> flags;                    // one per contact: kActive | kRedundant | kShared
  static constexpr std::uint8_t kActive = 1, kRedundant = 2, kShared = 4;

  // scratch
  SceneData dynamics;
  InvariantsData room;
  std::optional<ViewState> pending;  // the last state, not due for a frame
};

/// Takes the state where a frame is due; the last one given is taken in any case, by write_view.
void add_state(const ViewState& state, Recording& recording);

/// The states of a CSV in the columns of `simulate`, one by one: t, q:*, v:* of this scene in any order;
/// violation_position and violation_velocity where it has them. Other columns are left out. With `forces`, a CSV with t
/// and f:left[0] ... of all contacts: the forces of states at the same t; a contact whose are all 0 is not active then.
/// Throws InputError: a file cannot be read, a column is missing, a cell is no finite number, t does not grow, forces
/// at no state's time.
void read_trajectory(const std::string& path, const std::optional<std::string>& forces, const Scene& scene,
                     Recording& recording);

/// The page, one file that loads nothing else; "-" is standard output. Returns what the user should know, a line each.
/// Throws InputError when it cannot be written, UsageError when it would be larger than 500 MB.
std::vector<std::string> write_view(const SceneFile& file, Recording& recording, const std::string& path);

/// Recording for commands that can also write a view. recording_of throws UsageError for standard output,
/// InputError if the file cannot be written, and std::runtime_error as Recording does. No option: no recording.
std::optional<Recording> recording_of(const Arguments& arguments, const Scene& scene);
/// Writes the view if recording_of made a recording, and prints a line on `out`, if there is one.
void finish_view(const Arguments& arguments, const SceneFile& file, std::optional<Recording>& recording,
                 std::ostream* out);

}  // namespace manycontact::cli
