#pragma once
// A symmetric matrix is stored twice: sparse for the library, and dense.

#include <Eigen/Core>
#include <random>
#include <vector>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::test {

struct Symmetric {
  Eigen::MatrixXd dense;
  sparse::UpperCsc pattern;
  std::vector<double> x;

  /// The pattern is that of A's non-zeros, and the diagonal.
  explicit Symmetric(const Eigen::MatrixXd& A) : dense(A) {
    std::vector<std::pair<int, int>> entries;
    for (int j = 0; j < A.cols(); ++j)
      for (int i = 0; i < j; ++i)
        if (A(i, j) != 0) entries.emplace_back(i, j);
    pattern = sparse::make_pattern(static_cast<int>(A.cols()), std::move(entries));
    for (int j = 0; j < pattern.n; ++j)
      for (int k = pattern.p[j]; k < pattern.p[j + 1]; ++k) x.push_back(A(pattern.i[k], j));
  }
  int n() const { return pattern.n; }
};

inline Eigen::MatrixXd random_matrix(int rows, int cols, std::mt19937& rng) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd A(rows, cols);
  for (double& a : A.reshaped()) a = normal(rng);
  return A;
}

/// Returns off-diagonal entries that are kept with probability `density`; the matrix is indefinite.
inline Eigen::MatrixXd random_symmetric(int n, double density, std::mt19937& rng) {
  std::bernoulli_distribution keep(density);
  Eigen::MatrixXd A = random_matrix(n, n, rng);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < j; ++i) A(i, j) = A(j, i) = keep(rng) ? A(i, j) : 0.0;
  return A;
}

/// Returns such a matrix that is positive definite due to a dominant diagonal.
inline Eigen::MatrixXd random_positive(int n, double density, std::mt19937& rng) {
  Eigen::MatrixXd A = random_symmetric(n, density, rng);
  A.diagonal().setZero();
  const Eigen::VectorXd sums = A.cwiseAbs().rowwise().sum();
  A.diagonal() = sums.array() + 1;
  return A;
}

}  // namespace manycontact::test
