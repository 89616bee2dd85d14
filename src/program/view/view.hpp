#pragma once
// Common code of `manycontact view`, `simulate --view`, `optimize --view`: recordings of motions, and their page.

#include <optional>

#include "../command/command.hpp"
#include "manycontact/detail/simulation/invariants.hpp"
#include "manycontact/dynamics/data.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

/// A state of the motion. If neither `forces` nor torques `u` for a solve are given, the page shows no forces.
struct ViewState {
  double t = 0;  // s
  Eigen::VectorXd q, v;
  std::vector<char> active;                                 // one flag per contact
  std::optional<Eigen::VectorXd> u = {};                    // torques of this state
  std::optional<std::vector<Eigen::VectorXd>> forces = {};  // one entry per contact, in its reference frame
  std::optional<Eigen::Vector2d> drift = {};                // violations: position, velocity; default: computed
  std::optional<std::vector<Vec6<double>>> wrenches = {};   // wrenches; default: the scene's
};

/// The data that the page draws, one frame after the other.
struct Recording {
  /// Records at most `rate` frames per second. `scene` must outlive the recording. Throws std::runtime_error if the
  /// program was built without the page's parts.
  explicit Recording(const Scene& scene, double rate = 50);

  const Scene* scene;
  double rate;
  std::vector<double> friction;  // one entry per contact: coefficient of the cone drawn, the contact's mu; 0: none

  // These members have entries for each frame.
  std::vector<double> t;                                      // s
  std::vector<float> kinetic, potential;                      // J
  std::vector<float> violation_position, violation_velocity;  // constraint violations [m, rad], [m/s, rad/s]
  std::vector<float> positions;                               // 3 per body, m: bodies of all robots, in their order
  std::vector<std::int16_t> quaternions;                      // 4 per body, x y z w times 32767
  std::vector<std::int32_t> islands;                          // one per robot: the first robot of its island
  std::vector<float> points, normals, forces;                 // 3 per contact, in the world: A's origin, the contact's
                                                              // normal, the force on A [N], NaN: unknown
  std::vector<float> held;                                    // 6 per contact: origins of B' and of the frame that B
                                                              // is attached to, in the world [m]
  std::vector<float> wrenches, springs;  // 6 per external wrench: point of application, force; 6 per spring: its ends
  std::vector<std::uint8_t> flags;       // one per contact: kActive | kRedundant | kShared
  static constexpr std::uint8_t kActive = 1, kRedundant = 2, kShared = 4;

  // workspace
  SceneData dynamics;
  InvariantsData room;
  std::optional<ViewState> pending;  // the last state, if it is not recorded yet
};

/// Records the state if a frame is due. write_view records the last state in any case.
void add_state(const ViewState& state, Recording& recording);

/// Records the states of a CSV with the columns of `simulate`: t, q:*, v:* of this scene in any order, and
/// violation_position and violation_velocity if they exist. Other columns are ignored. With `forces`, a CSV with t and
/// f:left[0] ... of all contacts, a state has the forces of the row with equal t; contacts with forces of only zeros
/// are inactive. Throws InputError if a file cannot be read, a column is missing, a cell is not a finite number, t does
/// not increase, or forces have a time without a state.
void read_trajectory(const std::string& path, const std::optional<std::string>& forces, const Scene& scene,
                     Recording& recording);

/// Writes the page as one file without links to other files; "-" is standard output. Returns notes for the user, a line
/// each. Throws InputError if the file cannot be written, UsageError if it would be larger than 500 MB.
std::vector<std::string> write_view(const SceneFile& file, Recording& recording, const std::string& path);

/// Makes a recording if the option --view is given. Throws UsageError for standard output, InputError if the file
/// cannot be written, and std::runtime_error as Recording does.
std::optional<Recording> recording_of(const Arguments& arguments, const Scene& scene);
/// Writes the page if recording_of made a recording, and prints a line on `out` unless `out` is null.
void finish_view(const Arguments& arguments, const SceneFile& file, std::optional<Recording>& recording,
                 std::ostream* out);

}  // namespace manycontact::cli
