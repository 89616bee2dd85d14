#pragma once
// Eigen's dense decompositions for tests, compiled once: every file that names one itself takes seconds longer.

#include <Eigen/Core>

namespace manycontact::test {

/// A^-1 B, by LU.
Eigen::MatrixXd solved(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Of all X that minimise |A X - B| the one of least norm, by a complete orthogonal decomposition. Of A, what is below
/// `threshold` times the largest is nothing; 0: Eigen's own choice.
Eigen::MatrixXd least_norm(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double threshold = 0);

/// A^-1, by LU.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A);

/// By QR with pivoting: what is below `threshold` times the largest counts as nothing.
int rank_of(const Eigen::MatrixXd& A, double threshold);

/// A = U diag(sigma) V^T, U and V square, sigma descending.
struct Svd {
  explicit Svd(const Eigen::MatrixXd& A);
  Eigen::VectorXd sigma;
  Eigen::MatrixXd U, V;
};

/// Of a symmetric matrix, ascending.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A);

/// |A| |A^-1| in the 1-norm.
double condition_1(const Eigen::MatrixXd& A);

}  // namespace manycontact::test
