#pragma once
// Precision `extended`, and error bounds of any solution. A solution in double is refined with residuals r in
// double-double until a and f converge. Terms and x = [a; f] are in double-double; each correction is K^+ r by the
// system that solved (IslandSystem::invert). Forces of redundant rows are projected to the least norm.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "equations.hpp"
#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/report.hpp"

namespace manycontact {

struct SceneData;

struct ExtendedWork {
  explicit ExtendedWork(const Scene& scene);

  /// Data of one island during refinement, and afterwards for its error bounds.
  struct OfIsland {
    bool open = false;                    // whether the current iteration processes the island
    bool refined = false;                 // whether the island is to be refined; afterwards, whether it was
    bool converged = false;               // whether x has converged
    bool projects = false;                // whether rows are dependent, so that forces are projected
    double before = 0;                    // size of the previous correction
    double at_rest_a = 0, at_rest_f = 0;  // sizes of a, f that the loads may cause, to judge vanishing a, f
    double size_a = 0, size_f = 0;        // largest entries of a and f of the double solution
    double last_a = 0, last_f = 0;        // largest entries of the last correction
    double rest = 0;                      // largest entry of the f or r that is projected (equations.hpp)
    int steps = 0;
    Status status = Status::kOk;  // status of the solution, before its bounds
    Reason reason = Reason::kNone;
  };

  std::unique_ptr<extended::Equations> equations;
  std::vector<OfIsland> islands;
  std::uint64_t state = 0;            // the state (Workspace::state) of x
  std::vector<int> robots, contacts;  // robots and contacts of the open islands
  Eigen::VectorXd a, f;               // x, rounded to double
  Eigen::VectorXd r, r_a;             // residuals of contact rows and of dynamics
  Eigen::VectorXd weights, rest;      // row weights S, and scratch of projections: one entry per row of f
  std::vector<double> damping;        // one entry per contact: the scene's damping, or 0 (Reason::kDampingLost)
};

namespace internal {

void refine_extended(const Scene& scene, SceneData& data);  // refines, and replaces the double solution where converged
void refine_for_bounds(const Scene& scene, SceneData& data);  // refines a copy of the current solution
/// Sets error bounds of islands whose refined copy converged, from the distance to the copy. Call summarise afterwards.
void take_extended_bounds(const Scene& scene, SceneData& data);

}  // namespace internal

}  // namespace manycontact
