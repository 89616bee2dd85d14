#pragma once
// Code that `manycontact view`, `simulate --view` and `optimize --view` share: recordings of motions, and their page.

#include <optional>

#include "../command/command.hpp"
#include "manycontact/detail/simulation/invariants.hpp"
#include "manycontact/dynamics/data.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

/// A state of the motion. The page shows the forces of a solve with torques `u`, if given, or else `forces`, or none.
struct ViewState {
  double t = 0;  // s
  Eigen::VectorXd q, v;
  std::vector<char> active;                                 // one flag per contact
  std::optional<Eigen::VectorXd> u = {};                    // torques of this state
  std::optional<std::vector<Eigen::VectorXd>> forces = {};  // one entry per contact, in its reference frame
  std::optional<Eigen::Vector2d> drift = {};  // constraint violations of position and velocity; computed if not given
  std::optional<std::vector<Vec6<double>>> wrenches = {};  // external wrenches; those of the scene if not given
};

struct Recording {  // the data that the page draws, with one entry per frame
  /// Records at most `rate` frames per second. `scene` must outlive the recording. Throws std::runtime_error if the
  /// program was built without the page's parts.
  explicit Recording(const Scene& scene, double rate = 50);

  const Scene* scene;
  double rate;
  std::vector<double> friction;  // one entry per contact: mu of the friction cone that is drawn, or 0 for no cone

  // These members have entries for each frame.
  std::vector<double> t;                                      // s
  std::vector<float> kinetic, potential;                      // J
  std::vector<float> violation_position, violation_velocity;  // constraint violations [m, rad], [m/s, rad/s]
  std::vector<float> positions;                               // 3 per body [m]: bodies of all robots, in their order
  std::vector<std::int16_t> quaternions;                      // 4 per body, x y z w times 32767
  std::vector<std::int32_t> islands;                          // one per robot: the first robot of its island
  std::vector<float> points, normals, forces;                 // 3 per contact, in the world: A's origin, the contact's
                                                              // normal, the force on A [N], NaN: unknown
  std::vector<float> held;                                    // 6 per contact: origins of B' and of the frame that B
                                                              // is attached to, in the world [m]
  std::vector<float> wrenches, springs;  // 6 per wrench: point of application, force; 6 per spring: its ends
  std::vector<std::uint8_t> flags;       // one per contact: kActive | kRedundant | kShared
  static constexpr std::uint8_t kActive = 1, kRedundant = 2, kShared = 4;

  // workspace
  SceneData dynamics;
  InvariantsData room;
  std::optional<ViewState> pending;  // the last state, unless it is recorded already
};

/// Records the state if a frame is due. In any case write_view records the last state.
void add_state(const ViewState& state, Recording& recording);

/// Records the states of a CSV file with the columns of `simulate`: t, and q:*, v:* of this scene in any order. If they
/// exist, violation_position and violation_velocity are read too, and other columns are ignored. `forces` is a CSV file
/// with t and f:left[0] ... of all contacts. A state has the forces of the row with equal t, and contacts whose forces
/// are all zero are inactive. Throws InputError if a file cannot be read, a column is missing, a cell is not a finite
/// number, t does not increase, or forces have a time without a state.
void read_trajectory(const std::string& path, const std::optional<std::string>& forces, const Scene& scene,
                     Recording& recording);

/// Writes the page as one file without links to other files. "-" is standard output. Returns notes for the user, one
/// per line. Throws InputError if the file cannot be written, UsageError if it would be larger than 500 MB.
std::vector<std::string> write_view(const SceneFile& file, Recording& recording, const std::string& path);

/// Makes a recording if the option --view is given. Throws UsageError if its file is standard output, InputError if the
/// file cannot be written, and std::runtime_error as Recording does.
std::optional<Recording> recording_of(const Arguments& arguments, const Scene& scene);
/// Writes the page if recording_of made a recording, and prints a line on `out` unless `out` is null.
void finish_view(const Arguments& arguments, const SceneFile& file, std::optional<Recording>& recording,
                 std::ostream* out);

}  // namespace manycontact::cli
