#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "manycontact/abi.hpp"

namespace manycontact::rank {

/// Returns the x of least |x| among all that minimise |A x - b| (Euclidean norms). A: rows x cols; duplicate entries
/// are added. x is NaN where entries of A or b that are not finite affect it.
///
/// The method solves K [x; y] = [0; b] with K = [I A^T; A 0], with refinement, and drops dependent rows
/// (rank/dependent_rows.hpp). If rounding hides which rows are dependent, Eigen's complete orthogonal decomposition is
/// used. Source of K: Bjorck, Numerical Methods for Least Squares Problems (1996), sec. 2.5.
Eigen::VectorXd least_norm_solution(int rows, int cols, const std::vector<Eigen::Triplet<double>>& A,
                                    const Eigen::VectorXd& b);
/// Returns the least-norm solution for a dense A, by the complete orthogonal decomposition.
Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace manycontact::rank
