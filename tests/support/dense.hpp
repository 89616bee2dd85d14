#pragma once
// Eigen's dense decompositions for tests, compiled once: every file that uses one itself takes seconds longer.

#include <Eigen/Core>

namespace manycontact::test {

/// Returns A^-1 B, from LU.
Eigen::MatrixXd solved(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Returns the X of least norm among those that minimise |A X - B|, from a complete orthogonal decomposition. Parts of
/// A below `threshold` times the largest are zero; 0: Eigen's own choice.
Eigen::MatrixXd least_norm(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double threshold = 0);

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A);

/// Returns the rank from QR with pivoting: values below `threshold` times the largest are zero.
int rank_of(const Eigen::MatrixXd& A, double threshold);

/// A = U diag(sigma) V^T, U and V square, sigma descending.
struct Svd {
  explicit Svd(const Eigen::MatrixXd& A);
  Eigen::VectorXd sigma;
  Eigen::MatrixXd U, V;
};

/// Returns the eigenvalues of a symmetric matrix, ascending.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A);

/// Returns |A| |A^-1| in the 1-norm.
double condition_1(const Eigen::MatrixXd& A);

}  // namespace manycontact::test
