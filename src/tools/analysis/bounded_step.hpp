#pragma once
// Solves min |J x + e|^2 + mu |x|^2 over lower <= x <= upper for a sparse J, whose pattern is equal in all solves.

#include <Eigen/SparseCore>

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::internal {

/// Sparse LDL factor of J J^T + mu 1 in a minimum-degree order, for all or for selected columns of J.
class NormalMatrix {
 public:
  explicit NormalMatrix(const Eigen::SparseMatrix<double>& J);

  /// Factorizes J J^T + mu 1 for the columns j of J with counts[j] != 0.
  void factorize(const Eigen::SparseMatrix<double>& J, const std::vector<char>& counts, double mu);
  /// y <- (J J^T + mu 1)^-1 y
  void solve(Eigen::VectorXd& y);

 private:
  std::vector<int> iperm_;
  sparse::UpperCsc pattern_;
  sparse::LdlSymbolic symbolic_;
  sparse::LdlWorkspace work_;
  std::vector<int> slot_, diagonal_;  // one entry per pair of entries in a column of J; one per row
  std::vector<double> A_, L_, D_;
  Eigen::VectorXd permuted_;
};

class BoundedStep {
 public:
  explicit BoundedStep(const Eigen::SparseMatrix<double>& J) : normal_(J) {}

  /// Computes the minimum x. Requires mu > 0 and lower <= 0 <= upper; bounds may be infinite.
  void solve(const Eigen::SparseMatrix<double>& J, const Eigen::VectorXd& e, double mu, const Eigen::VectorXd& lower,
             const Eigen::VectorXd& upper, Eigen::VectorXd& x);

 private:
  NormalMatrix normal_;
};

}  // namespace manycontact::internal
