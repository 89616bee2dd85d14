#include "support/dense.hpp"

#include <Eigen/Dense>

namespace manycontact::test {

using Eigen::MatrixXd;

MatrixXd solved(const MatrixXd& A, const MatrixXd& B) {
  return A.size() == 0 ? B : MatrixXd(A.partialPivLu().solve(B));
}

MatrixXd least_norm(const MatrixXd& A, const MatrixXd& B, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  if (threshold > 0) decomposition.setThreshold(threshold);
  decomposition.compute(A);
  return decomposition.solve(B);
}

MatrixXd inverse_of(const MatrixXd& A) { return A.partialPivLu().inverse(); }

int rank_of(const MatrixXd& A, double threshold) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
  qr.setThreshold(threshold);
  return static_cast<int>(qr.rank());
}

Svd::Svd(const MatrixXd& A) {
  const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  sigma = svd.singularValues(), U = svd.matrixU(), V = svd.matrixV();
}

Eigen::VectorXd eigenvalues(const MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

double condition_1(const MatrixXd& A) {
  const auto norm_1 = [](const MatrixXd& B) { return B.cwiseAbs().colwise().sum().maxCoeff(); };
  return norm_1(A) * norm_1(inverse_of(A));
}

}  // namespace manycontact::test
