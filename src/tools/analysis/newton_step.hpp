#pragma once
// Newton steps for min |e(q)|^2 / 2 within limits. The Gauss-Newton Hessian J^T J lacks the curvature term
// sum e_i e_i'', so that Gauss-Newton steps converge slowly if e remains large.

#include <functional>

#include "bounded_step.hpp"

namespace manycontact::internal {

/// Computes a Newton step by conjugate gradients (Steihaug, SIAM J. Numer. Anal. 20, 1983) in the coordinates that are
/// not at a limit. Hessian products are finite differences of J^T e. The preconditioner is J^T J + |e| 1. A coordinate
/// that reaches its limit remains there. A direction of negative curvature is followed up to a limit.
class NewtonStep {
 public:
  using Gradient = std::function<Eigen::VectorXd(const Eigen::VectorXd& dq)>;  // gradient(dq) returns J^T e at q (+) dq

  explicit NewtonStep(const Eigen::SparseMatrix<double>& J) : normal_(J) {}

  /// Computes the step x. Bounds must be finite. Returns the decrease of |e|^2 / 2 that the quadratic model predicts.
  double solve(const Eigen::SparseMatrix<double>& J, double size_of_e, const Gradient& gradient,
               const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, Eigen::VectorXd& x);

 private:
  void precondition(const Eigen::SparseMatrix<double>& J, double mu, const Eigen::VectorXd& r, Eigen::VectorXd& z);

  NormalMatrix normal_;
  std::vector<char> free_;
};

}  // namespace manycontact::internal
