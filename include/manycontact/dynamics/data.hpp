#pragma once
// The variable part of a scene: what is asked, the answer, and the memory it is worked out in. One per thread; the
// Scene stays constant and may be shared.
//
// Data belong to the scene they were made for. Under data in use may change: gravity, damping, tolerance,
// moment_length, fixed bases' placements, of a contact B's placement, reference frame and gains, of pushes and springs
// all but their bodies. Robots and their models, the number of contacts, and of a contact its type, A, B's body and
// axis may not, nor bodies that pushes and springs are on: every function that takes both throws std::invalid_argument
// where these differ, and new data are needed. (A copy of the scene without any pushes and springs may be solved with
// its data: nothing of that kind acts then.)

#include <cstdint>
#include <memory>

#include "manycontact/dynamics/report.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// An answer. Written by solve and solve_tau alone; estimate_condition and estimate_errors complete the report.
struct Solution {
  std::uint64_t serial = 0;   // number of the solve, 1, 2, ...; 0: there is no answer, or it was given up
  Eigen::VectorXd v, tau;     // nv: the velocity and the torques solved at, friction of joints,
                              // pushes and springs included [m/s, rad/s; N, N m]
  Eigen::VectorXd a;          // nv: accelerations [m/s^2, rad/s^2]
  Eigen::VectorXd f;          // rows of the active contacts, in the scene's order: forces on A in the contact's
                              // reference frame [N, N m]
  std::vector<int> f_offset;  // per contact: its first row in f, -1 when not active; by prepare
  Report report;              // what the answer is worth
};

struct Workspace;  // private to floor dynamics

struct SceneData : Solution {                                           // The variable part of a scene, one per thread.
  explicit SceneData(const Scene& scene, const Options& options = {});  // for this scene alone
  ~SceneData();
  SceneData(SceneData&&) noexcept;  // moved from, it is of no scene
  SceneData& operator=(SceneData&&) noexcept;

  // the caller's, between solves
  Options options;
  std::vector<char> active;          // one per contact: as the scene has it at first
  std::vector<Vec6<double>> pushes;  // one per push: its wrench, as the scene has it at first [N, N m]

  std::unique_ptr<Workspace> workspace;
};

/// Finds the islands of data.active and sets up their systems, unless they are set up already. `solve` calls it. What
/// was analysed for any contact set before is not analysed again, and only islands change whose contacts were switched.
/// Throws std::invalid_argument when data are not of this scene, or `active` has another size.
void prepare(const Scene& scene, SceneData& data);

/// "left[0]" for each row of f. After prepare or solve.
std::vector<std::string> force_names(const Scene& scene, const SceneData& data);

/// The rows of f that are a contact's, by its name or number: what it exerts on A, in its reference frame [N, N m].
/// Valid until the data's next call. Throws std::invalid_argument for a contact that does not exist, with the nearest
/// name, std::logic_error for one that is not active and before the first solve.
Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SceneData& data,
                                                        const std::string& contact);
Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SceneData& data, int contact);

}  // namespace manycontact
