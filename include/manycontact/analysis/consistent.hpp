#pragma once
// A state that fits its contacts: they are in place, and nothing moves against them. With e the contacts' errors of
// placement (contact/rows.hpp, its alpha term) and J their rows,
//
//     q := q (+) dq     min dq^T M dq   over the dq with least |J dq + e|    again and again, until e is rounding
//     v := v + dv       min dv^T M dv   over the dv with least |J dv + J v|  once, at that q
//
// Each is a solve of the scene at rest, without gravity, of which the contacts ask for a motion: [M J^T; J 0],
// redundant contacts included. The first is Gauss-Newton's method, each step the least motion in the kinetic metric;
// where |e| does not fall, the contacts are damped until it does (Levenberg and Marquardt): [M J^T; J -delta I]. The
// second is what an impact does to v (simulation/switch.hpp).
//
// Metres and radians count alike in |e|. Limits of joints are not looked at.

#include "manycontact/analysis/findings.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact {

struct ConsistentState {                  // The state found, and what it lacks.
  Eigen::VectorXd q, v;                   // nq, nv
  Status status = Status::kOk;            // the worst of its solves; kFailed: it was given up there
  int steps = 0;                          // of Gauss-Newton
  std::vector<PlacementError> misplaced;  // contacts that could not be put in place from where they were
  std::vector<VelocityError> moving;      // contacts that still move

  /// Whether contacts are in place and nothing moves against them.
  bool consistent() const { return misplaced.empty() && moving.empty(); }
};

/// The nearest state to q (nq), v (nv) found that the contacts flagged `active` allow. Where they cannot all be in
/// place, or not be reached from here, q is where |e| was least, and they are listed. Throws std::invalid_argument
/// unless sizes fit.
ConsistentState make_consistent(const Scene& scene, const std::vector<char>& active,
                                const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Ref<const Eigen::VectorXd>& v,
                                const Options& options = {});
/// The same with the contacts that the scene has active.
ConsistentState make_consistent(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                                const Eigen::Ref<const Eigen::VectorXd>& v, const Options& options = {});

/// For a scene file that asks for it by consistent="true": makes its q, v so, with a finding of kind "consistent" that
/// says what moved. Throws InputError where contacts stay out of place or moving, or a robot has no inertia there.
void make_consistent(SceneFile& file);

}  // namespace manycontact
