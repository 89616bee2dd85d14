#pragma once
// Other contact forces for the same motion. If contacts are redundant, the forces f of a solve are one choice: every
//
//     f + N y,    J^T N = 0,
//
// causes the same accelerations. The columns of N are a basis of the null space of J^T. These functions compute N, and
// the forces closest to given ones. For conditions such as friction cones, find y with N in a quadratic program.

#include <Eigen/SparseCore>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Computes an orthonormal basis N of the null space of J^T after a solve at q (scene.nq). N has data.f.size() rows and
/// nc - rank columns per island; it is block diagonal by island. It has no columns for scenes with damping, which makes
/// all forces unique, and for failed islands. Each column costs a few solves of the scene at rest. Allocates. Throws
/// std::logic_error before a solve, std::invalid_argument for a wrong size of q. Thread-safe for distinct data.
Eigen::SparseMatrix<double> force_null_space(const Scene& scene, const ConstVectorRef& q, const SceneData& data);

/// Computes the forces f' (data.f.size()) with J^T f' = J^T f that minimise
///
///     sum_i weights_i (f'_i - reference_i)^2
///
/// after a solve at q (scene.nq). They cause the same accelerations as data.f, which remains unchanged. `reference`:
/// forces to come close to, in the order of data.f [N, N m]; empty means zero, the least norm in the metric of the
/// weights. To move forces into friction cones, use forces along the contacts' normals, or alternate with projections
/// onto the cones. `weights`: above 0; empty means ones. Rows of failed islands are NaN. Costs as force_null_space.
///
/// Throws std::logic_error before a solve. Throws std::invalid_argument for wrong sizes, numbers that are not finite,
/// and weights that are not above 0. Thread-safe for distinct data.
Eigen::VectorXd redistribute_forces(const Scene& scene, const ConstVectorRef& q, const SceneData& data,
                                    const Eigen::VectorXd& reference = {}, const Eigen::VectorXd& weights = {});

}  // namespace manycontact
