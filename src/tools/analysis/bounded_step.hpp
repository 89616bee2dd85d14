#pragma once
// Solves min |J x + e|^2 + mu |x|^2 over lowest <= x <= highest for a sparse J. All solves share one pattern of J.

#include <Eigen/SparseCore>

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::internal {

/// The factor of J J^T + mu 1 by sparse LDL in a minimum-degree order. Selected columns of J can be used.
class NormalMatrix {
 public:
  explicit NormalMatrix(const Eigen::SparseMatrix<double>& J);

  /// Uses the values of J and the columns with counts[j] != 0.
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

  /// Computes x. Requires mu > 0 and lower <= 0 <= upper, which may be infinite.
  void solve(const Eigen::SparseMatrix<double>& J, const Eigen::VectorXd& e, double mu, const Eigen::VectorXd& lower,
             const Eigen::VectorXd& upper, Eigen::VectorXd& x);

 private:
  NormalMatrix normal_;
};

}  // namespace manycontact::internal
