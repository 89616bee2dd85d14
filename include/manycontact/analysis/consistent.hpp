#pragma once
// Computes a state that is consistent with the contacts: their placement errors and velocities are zero. With e the
// placement errors (detail/contact/rows.hpp, the alpha term) and J the constraint rows,
//
//     q := q (+) dq     min dq^T M dq   over the dq with least |J dq + e|    repeated until e is a rounding error
//     v := v + dv       min dv^T M dv   over the dv with least |J dv + J v|  once, at the final q
//
// Each step is one solve with [M J^T; J 0] of the scene at rest, without gravity, with a prescribed motion of the
// contacts. Contacts may be redundant. The steps of q are Gauss-Newton steps of least norm in the mass-weighted norm.
// If a step does not decrease |e|, -delta I replaces the zero block (Levenberg-Marquardt). The velocity v is computed
// as for an impact (simulation/switch.hpp). In |e|, a metre and a radian have the same weight. Joint limits are
// ignored.

#include "manycontact/analysis/findings.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact {

struct ConsistentState {                  // The state found, and its remaining errors.
  Eigen::VectorXd q, v;                   // nq, nv
  Status status = Status::kOk;            // the worst status of the solves; kFailed: the computation ended there
  int steps = 0;                          // Gauss-Newton steps
  std::vector<PlacementError> misplaced;  // contacts that could not be brought into place
  std::vector<VelocityError> moving;      // contacts that still move

  /// Returns whether all contacts are in place and none of them moves.
  bool consistent() const { return misplaced.empty() && moving.empty(); }
};

/// Finds a state near q (nq), v (nv) that is consistent with the contacts flagged `active`. If contacts cannot be
/// brought into place, `q` is the configuration with the least |e| found, and `misplaced` lists these contacts. Throws
/// std::invalid_argument for wrong sizes. Allocates; each step costs a solve. Thread-safe.
ConsistentState make_consistent(const Scene& scene, const std::vector<char>& active, const ConstVectorRef& q,
                                const ConstVectorRef& v, const Options& options = {});
/// Calls make_consistent with the contacts that are active in the scene.
ConsistentState make_consistent(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                const Options& options = {});

/// Makes q and v of a scene file with consistent="true" consistent, and adds a finding of kind "consistent" that states
/// what moved. Throws InputError if contacts remain out of place or moving, or if a robot's inertia is singular.
void make_consistent(SceneFile& file);

}  // namespace manycontact
