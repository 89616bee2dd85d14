#pragma once
// The precision `extended`, and bounds of the errors of any solution: a solution in double, of whichever system, is
// refined with residuals in double-double until a and f do not change any more. The terms of the scene are evaluated in
// double-double, x = [a; f] is one, and each correction is K^+ r by the system that solved (IslandSystem::invert).
// Forces of dependent rows are projected so that they have the least norm, in double-double too.

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

  /// The data of one island during refinement, and afterwards for its error bounds.
  struct OfIsland {
    bool open = false;                    // it is at work
    bool refined = false;                 // it is to be refined; afterwards: it is
    bool converged = false;               // x has
    bool projects = false;                // rows of the island depend on each other
    double before = 0;                    // size of the last correction
    double at_rest_a = 0, at_rest_f = 0;  // sizes that vanishing a and f are compared with
    double size_a = 0, size_f = 0;        // the largest of a and f, as the double solution had them
    double last_a = 0, last_f = 0;        // the last correction
    double rest = 0;                      // size of the rest that is projected
    int steps = 0;
    Status status = Status::kOk;  // status of the solution, before its bounds
    Reason reason = Reason::kNone;
  };

  std::unique_ptr<extended::Equations> equations;
  std::vector<OfIsland> islands;
  std::uint64_t state = 0;            // the state that they belong to (Workspace::state)
  std::vector<int> robots, contacts;  // robots and contacts of the islands at work
  Eigen::VectorXd a, f;               // x, rounded
  Eigen::VectorXd r, r_a;             // residuals of the scene
  Eigen::VectorXd weights, rest;      // one entry per row of f
  std::vector<double> damping;        // one entry per contact: the scene's, or none where it was lost in rounding
};

namespace internal {

/// Refines the current double solution, and takes the result where that converges.
void refine_extended(const Scene& scene, SceneData& data);
/// Refines a copy of the current solution, of any precision.
void refine_for_bounds(const Scene& scene, SceneData& data);
/// Bounds of errors by the distance to the copy, where that converged, in place of those by |K^-1|, which the report
/// has. It is to be summarised then.
void take_extended_bounds(const Scene& scene, SceneData& data);

}  // namespace internal

}  // namespace manycontact
