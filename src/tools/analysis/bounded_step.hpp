#pragma once
// Solves min |J x + e|^2 + mu |x|^2 over lower <= x <= upper for sparse J with the same pattern in all solves.

#include <Eigen/SparseCore>

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::internal {

/// A sparse LDL factor of J J^T + mu 1 in a minimum-degree order, where J has all or only selected columns.
class NormalMatrix {
 public:
  explicit NormalMatrix(const Eigen::SparseMatrix<double>& J);

  /// Factorizes J_s J_s^T + mu 1, where J_s contains the columns j of J with counts[j] != 0.
  void factorize(const Eigen::SparseMatrix<double>& J, const std::vector<char>& counts, double mu);
  void solve(Eigen::VectorXd& y);  // replaces y by (J J^T + mu 1)^-1 y

 private:
  std::vector<int> iperm_;
  sparse::UpperCsc pattern_;
  sparse::LdlSymbolic symbolic_;
  sparse::LdlWorkspace work_;
  // slot_: positions in A_, one per pair of nonzeros in a column of J; diagonal_: positions of the diagonal
  std::vector<int> slot_, diagonal_;
  std::vector<double> A_, L_, D_;
  Eigen::VectorXd permuted_;
};

class BoundedStep {
 public:
  explicit BoundedStep(const Eigen::SparseMatrix<double>& J) : normal_(J) {}

  /// Computes the minimiser x. Requires mu > 0 and lower <= 0 <= upper; bounds may be infinite.
  void solve(const Eigen::SparseMatrix<double>& J, const Eigen::VectorXd& e, double mu, const Eigen::VectorXd& lower,
             const Eigen::VectorXd& upper, Eigen::VectorXd& x);

 private:
  NormalMatrix normal_;
};

}  // namespace manycontact::internal
