#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "manycontact/abi.hpp"

namespace manycontact::rank {

/// The x of least |x| among all that minimise |A x - b| (Euclidean norms). A: rows x cols, entries that meet add up.
/// NaN where A or b is not finite, in x that share rows with it.
///
/// [x; y] solves K [x; y] = [0; b] with K = [I A^T; A 0], rows of A that depend on others dropped as dependent_rows.hpp
/// has it, and refined. Where rounding hides which rows these are, Eigen's complete orthogonal decomposition is used.
/// Source of the augmented form: Bjorck, Numerical Methods for Least Squares Problems (1996), sec. 2.5.
Eigen::VectorXd least_norm_solution(int rows, int cols, const std::vector<Eigen::Triplet<double>>& A,
                                    const Eigen::VectorXd& b);
/// The same for a dense A, by that decomposition at once.
Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace manycontact::rank
