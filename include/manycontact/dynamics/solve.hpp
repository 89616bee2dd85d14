#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

using ConstVector = Eigen::Ref<const Eigen::VectorXd>;

/// Contact forward dynamics: accelerations data.a and contact forces data.f of the scene at q (nq), v (nv), u (nu, the
/// torques of the actuated coordinates), by
///
///     [ M  J^T     ] [  a ]   [ S^T u - h ]
///     [ J  -delta I] [ -f ] = [   -a0     ]
///
/// per island, with data.options.method. Returns data.report, whose status says what the answer is worth; a failed
/// island's a and f are NaN. Allocates nothing when the active set is the last one's (CHOLMOD and dense paths excepted).
/// Throws std::invalid_argument when a size does not fit the scene.
const Report& solve(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& u,
                    SceneData& data);

/// After solve: the 1-norm condition number of each island's K, estimated by a few solves with the factor at hand
/// (Hager, Higham), into the report. Of a singular K with dependent rows: |K|_1 |K^+|_1 of the generalised inverse used.
void estimate_condition(const Scene& scene, SceneData& data);

}  // namespace manycontact
