#pragma once
// K = [M J^T; J 0] has rows of J that depend on others by construction.

#include <Eigen/Core>
#include <ostream>
#include <string>

#include "sparse/symmetric.hpp"

namespace manycontact::test {

struct SaddlePoint {
  std::string name;
  Eigen::MatrixXd M, J;
  std::vector<int> dropped = {};  // rows of J that depend on those before them
  int clusters = 0;               // of dropped rows that depend on common rows

  int nv() const { return static_cast<int>(M.rows()); }
  int nc() const { return static_cast<int>(J.rows()); }
  int n() const { return nv() + nc(); }
  double J_size() const { return J.size() == 0 ? 0 : J.cwiseAbs().maxCoeff(); }
  Eigen::MatrixXd dense() const {
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n(), n());
    K.topLeftCorner(nv(), nv()) = M;
    K.bottomLeftCorner(nc(), nv()) = J;
    K.topRightCorner(nv(), nc()) = J.transpose();
    return K;
  }
};

// Prints the name in gtest's messages.
inline void PrintTo(const SaddlePoint& s, std::ostream* out) { *out << s.name; }

inline Eigen::MatrixXd block_diagonal(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(A.rows() + B.rows(), A.cols() + B.cols());
  out.topLeftCorner(A.rows(), A.cols()) = A;
  out.bottomRightCorner(B.rows(), B.cols()) = B;
  return out;
}

inline std::vector<SaddlePoint> saddle_points() {
  std::mt19937 rng(41);
  const auto inertia = [&rng](int n) { return random_positive(n, 0.4, rng); };
  const auto rows = [&rng](int m, int n) { return random_matrix(m, n, rng); };
  std::vector<SaddlePoint> out;
  out.push_back({"none dependent", inertia(9), rows(5, 9)});
  out.push_back({"no rows", inertia(4), rows(0, 4)});

  Eigen::MatrixXd J = rows(6, 8);
  J.row(4) = -2 * J.row(1);
  out.push_back({"a row twice as long", inertia(8), J, {4}, 1});
  J = rows(1, 7).replicate(5, 1);
  out.push_back({"one row five times", inertia(7), J, {1, 2, 3, 4}, 1});
  J = rows(8, 3) * rows(3, 11);
  out.push_back({"rank 3 of 8", inertia(11), J, {3, 4, 5, 6, 7}, 1});
  out.push_back({"more rows than columns", inertia(4), rows(9, 4), {4, 5, 6, 7, 8}, 1});

  J = rows(7, 10);
  J.row(3) = J.row(0) - J.row(1);
  J.row(4) = J.row(1) + 3 * J.row(2);
  J.row(6) = J.row(5);
  out.push_back({"clusters that share a row, and one apart", inertia(10), J, {3, 4, 6}, 2});
  Eigen::MatrixXd A = rows(4, 5), B = rows(3, 6);
  A.row(2) = A.row(0) + A.row(1);
  A.row(3) = A.row(0);
  B.row(2) = 0.5 * B.row(1);
  out.push_back({"two islands", block_diagonal(inertia(5), inertia(6)), block_diagonal(A, B), {2, 3, 6}, 2});

  J = rows(5, 6);
  J.row(0).setZero();
  J.row(3).setZero();
  out.push_back({"zero rows", inertia(6), J, {0, 3}, 2});
  out.push_back({"nothing but zero rows", inertia(6), Eigen::MatrixXd::Zero(4, 6), {0, 1, 2, 3}, 4});
  J = rows(5, 9);
  J.row(0) *= 0.05;
  J.row(3) = 20 * J.row(0) + J.row(1);
  out.push_back({"a small row kept before larger ones", inertia(9), J, {3}, 1});
  J = rows(6, 9);
  J.row(2) = J.row(0) + 3e-5 * J.row(2);
  J.row(4) = J.row(0) + J.row(2) - J.row(1);
  J.row(5) = J.row(2) - J.row(3);
  out.push_back({"rows kept that nearly coincide", inertia(9), J, {4, 5}, 1});
  return out;
}

}  // namespace manycontact::test
