#pragma once
// Other contact forces for the same motion. If contacts are redundant, a solve's forces f are one choice: for any y
//
//     f + N y,    J^T N = 0,
//
// causes the same accelerations. The columns of N are a basis of the null space of J^T, with J the contact rows. These
// functions compute N, and the forces closest to given forces. Forces inside friction cones require a y that a
// quadratic program determines.

#include <Eigen/SparseCore>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Computes an orthonormal basis N of the null space of J^T after a solve at q (nq). N has data.f.size() rows and, per
/// island of nc rows, nc - rank columns with entries only in the rows of the island. N has no columns for failed
/// islands or with damping (unique forces). Each column costs a few solves of the scene at rest. Allocates. Throws
/// std::logic_error before a solve, std::invalid_argument for a wrong size of q. Thread-safe for distinct data.
Eigen::SparseMatrix<double> force_null_space(const Scene& scene, const ConstVectorRef& q, const SceneData& data);

/// Computes the forces f' (data.f.size()) with J^T f' = J^T f that minimise
///
///     sum_i weights_i (f'_i - reference_i)^2
///
/// after a solve at q (scene.nq). f' causes the same accelerations as data.f, which remains unchanged. `reference`:
/// forces to come close to, in the order of data.f [N, N m]; empty means zero, the least norm in the metric of the
/// weights. To move forces into friction cones, use forces along the contacts' normals, or alternate with projections
/// onto the cones. `weights`: above 0; empty means ones. Rows of failed islands are NaN. Costs as much as the basis.
///
/// Throws std::logic_error before a solve. Throws std::invalid_argument for wrong sizes, numbers that are not finite,
/// and weights that are not above 0. Thread-safe for distinct data.
Eigen::VectorXd redistribute_forces(const Scene& scene, const ConstVectorRef& q, const SceneData& data,
                                    const Eigen::VectorXd& reference = {}, const Eigen::VectorXd& weights = {});

}  // namespace manycontact
