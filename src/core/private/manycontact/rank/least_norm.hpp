#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "manycontact/abi.hpp"

namespace manycontact::rank {

/// Returns the x of least |x| among all that minimise |A x - b| (Euclidean norms). Duplicate entries of A are added. x
/// is NaN where entries of A or b that are not finite affect it. Method: L D L^T of [I A^T; A 0], without dependent
/// rows (rank/dependent_rows.hpp), or Eigen's complete orthogonal decomposition if rounding hides the rank. Source:
/// Bjorck, Numerical Methods for Least Squares Problems (1996), sec. 2.5.
Eigen::VectorXd least_norm_solution(int rows, int cols, const std::vector<Eigen::Triplet<double>>& A,
                                    const Eigen::VectorXd& b);
Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);  // dense A

}  // namespace manycontact::rank
