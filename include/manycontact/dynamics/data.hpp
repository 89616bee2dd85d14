#pragma once
// SceneData is the variable part of a scene: inputs other than q, v, u, the solution, and the workspace. Use one
// SceneData per thread. The Scene is only read and may be shared by threads.
//
// A SceneData belongs to the scene it was made for. While it is in use, the following members of the scene may change:
//
// - gravity, damping, tolerance and moment_length;
// - the placements of fixed bases;
// - the placement of B, the reference frame and the gains of a contact;
// - everything of external wrenches and springs except their bodies.
//
// The following may not change: robots and their models, the number of contacts, the type, A, axis and body of B of a
// contact, and the bodies of external wrenches and springs. After such a change every function that takes the scene and
// the data throws std::invalid_argument, and a new SceneData is needed. There is one exception: a copy of the scene
// without any external wrenches and springs may be solved with the data of the scene.

#include <cstdint>
#include <memory>

#include "manycontact/dynamics/report.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// A solution. Only solve and solve_tau write it; estimate_condition and estimate_errors complete its report.
struct Solution {
  std::uint64_t serial = 0;   // number of the solve: 1, 2, ...; 0 if there is no solution
  Eigen::VectorXd v, tau;     // nv: velocity [m/s, rad/s] and total torques [N, N m] of the solve; tau includes joint
                              // friction, external wrenches and springs
  Eigen::VectorXd a;          // nv: accelerations [m/s^2, rad/s^2]
  Eigen::VectorXd f;          // one entry per constraint row of the active contacts, in the scene's order: forces on A,
                              // expressed in the contact's reference frame [N, N m]
  std::vector<int> f_offset;  // one entry per contact: its first row in f, or -1 if it is not active; set by prepare
  Report report;              // status and accuracy of the solution
};

struct Workspace;  // private to the module dynamics

struct SceneData : Solution {                                           // The variable part of a scene, one per thread.
  explicit SceneData(const Scene& scene, const Options& options = {});  // for use with this scene only
  ~SceneData();
  SceneData(SceneData&&) noexcept;  // the moved-from data belong to no scene
  SceneData& operator=(SceneData&&) noexcept;

  // These members are set by the caller, between solves.
  Options options;
  std::vector<char> active;          // one flag per contact; initially as in the scene
  std::vector<Vec6<double>> wrenches;  // the external wrenches [N, N m], each in its own axes; initially the scene's

  std::unique_ptr<Workspace> workspace;
};

/// Finds the islands (robots coupled by springs and by the contacts flagged in data.active) and sets up their systems,
/// unless this was done already. `solve` calls `prepare`. Sets of contacts that occurred before are not analysed again,
/// and only islands whose contacts were switched change. Throws std::invalid_argument if the data belong to another
/// scene, or if `active` has a wrong size. Thread-safe for distinct data. The cost is a symbolic factorization for each
/// new island.
void prepare(const Scene& scene, SceneData& data);

/// Returns the names of the rows of f: "left[0]", ... Call it after prepare or solve.
std::vector<std::string> force_names(const Scene& scene, const SceneData& data);

/// Return the force of a contact, given by name or number: the contact's rows of f, exerted on A and expressed in the
/// contact's reference frame [N, N m]. The view remains valid until the next call with the data. Throws
/// std::invalid_argument for a contact that does not exist, and suggests the nearest name. Throws std::logic_error if
/// the contact is not active, or before the first solve.
Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SceneData& data,
                                                        const std::string& contact);
Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SceneData& data,
                                                        ContactIndex contact);

}  // namespace manycontact
