#pragma once
// Rows of J that others nearly explain, J_n = Z J_k + R with R small but more than rounding: in K's pivots R is squared
// and lost there, among J's own entries it is not. So they are left out of the factor as if they depended, and K_k, the
// system of the rows kept, is bordered by R with each row over its size, in which there is nothing small:
//
//   [M   J_k^T R^T] [a ]   [b1       ]     y_k = y' - Z^T y_n
//   [J_k          ] [y'] = [b_k      ]
//   [R            ] [y_n]  [b_n - Z b_k]
//
// by V = K_k^-1 [R^T; 0] and the Schur complement S = R V_a.

#include <Eigen/Cholesky>

#include "ldl_numbers.hpp"
#include "manycontact/sparse/dependent_rows.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

class NearRows {
 public:
  bool empty() const { return count_ == 0; }
  void clear() { count_ = 0; }

  /// Takes those rows dropped that nearly depend out of `rows`, which keeps the others and their null space, and factors
  /// S. False where a row is neither, or S has a pivot that is nothing. K, the LDL of the rows kept, nv, row_scale: as in
  /// find_null_space.
  bool take(const KktMatrix& K, const LdlNumbers& ldl, const double* row_scale, sparse::DependentRows& rows) {
    const int n = K.size(), nv = K.nv();
    if (rows.largest_entry > tolerance::kLargestEntry) return false;
    sparse::take_near_rows(K.pattern->K, K.values.data(), nv, row_scale, rows, near_);
    count_ = static_cast<int>(near_.rows.size());
    if (count_ == 0 || count_ > kMost || !rows.accepted()) return false;
    V_.setZero(n, count_);
    for (int c = 0; c < count_; ++c) {
      each_R(c, [&](int i, double r) { V_(i, c) = r; });
      ldl.solve(V_.col(c).data());
    }
    S_.resize(count_, count_);
    for (int c = 0; c < count_; ++c) {
      S_.row(c).setZero();
      each_R(c, [&](int i, double r) { S_.row(c) += r * V_.row(i); });
    }
    llt_.compute(S_);
    if (llt_.info() != Eigen::Success) return false;
    for (int c = 0; c < count_; ++c) {
      const double l = llt_.matrixLLT()(c, c);
      if (!(l * l > tolerance::kPivotLeft * S_(c, c))) return false;
    }
    return true;
  }

  /// Around x <- K_k^-1 x, of rows X(k) of K in order of elimination, k < n: one number each, or many.
  template <class Rows>
  void before(Rows&& X, int cols) {
    b_.resize(count_, cols);
    for (int c = 0; c < count_; ++c) {
      b_.row(c).setZero();
      for (int p = near_.Zp[c]; p < near_.Zp[c + 1]; ++p) b_.row(c) += near_.Zx[p] * X(near_.Zi[p]);  // b_n - Z b_k
      b_.row(c) /= near_.size[c];
    }
    for (int k : near_.rows) X(k).setZero();
  }
  template <class Rows>
  void after(Rows&& X, int n) {
    b_ *= -1;
    for (int c = 0; c < count_; ++c) each_R(c, [&](int i, double r) { b_.row(c) += r * X(i); });
    llt_.solveInPlace(b_);
    for (int k = 0; k < n; ++k) X(k).noalias() -= V_.row(k) * b_;
    for (int c = 0; c < count_; ++c)
      for (int p = near_.Zp[c]; p < near_.Zp[c + 1]; ++p) X(near_.Zi[p]) += near_.Zx[p] / near_.size[c] * b_.row(c);
  }

 private:
  static constexpr int kMost = 200;
  // use(row of K, entry of R over the row's size)
  template <class Use>
  void each_R(int c, Use&& use) const {
    for (int p = near_.Rp[c]; p < near_.Rp[c + 1]; ++p) use(near_.Ri[p], near_.Rx[p] / near_.size[c]);
  }

  sparse::NearlyDependentRows near_;
  int count_ = 0;
  Eigen::MatrixXd V_, S_, b_;
  Eigen::LLT<Eigen::MatrixXd> llt_{Eigen::MatrixXd::Identity(1, 1)};
};

}  // namespace manycontact::internal
