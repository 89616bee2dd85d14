#include "dense.hpp"

#include <Eigen/Cholesky>

namespace manycontact::lq {

namespace {

// Eigen's product into a triangle divides by zero where there is nothing to multiply.
bool nothing(ConstBlock C, ConstBlock A) { return C.size() == 0 || A.size() == 0; }

}  // namespace

void add_AB(Block C, double a, ConstBlock A, ConstBlock B) { C.noalias() += a * A * B; }
void add_AtB(Block C, double a, ConstBlock A, ConstBlock B) { C.noalias() += a * A.transpose() * B; }
void add_ABt(Block C, double a, ConstBlock A, ConstBlock B) { C.noalias() += a * A * B.transpose(); }

void add_lower_AB(Block C, double a, ConstBlock A, ConstBlock B) {
  if (!nothing(C, A)) C.triangularView<Eigen::Lower>() += a * A * B;
}

void add_lower_AtB(Block C, double a, ConstBlock A, ConstBlock B) {
  if (!nothing(C, A)) C.triangularView<Eigen::Lower>() += a * A.transpose() * B;
}

void add_lower_ABt(Block C, double a, ConstBlock A, ConstBlock B) {
  if (!nothing(C, A)) C.triangularView<Eigen::Lower>() += a * A * B.transpose();
}

void copy_lower_to_upper(Block C) { C.triangularView<Eigen::StrictlyUpper>() = C.transpose(); }

// Pivot k is L_kk^2 = A_kk - sum_j L_kj^2; the part of A_kk that it keeps is judged afterwards.
bool cholesky(Block A, double least) {
  if (A.rows() == 0) return true;
  if (Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(A).info() != Eigen::Success) return false;
  for (Eigen::Index k = 0; k < A.rows(); ++k) {
    const double pivot = A(k, k) * A(k, k);
    if (!(pivot > least * (pivot + A.row(k).head(k).squaredNorm()))) return false;
  }
  return true;
}

void solve_L(ConstBlock L, Block X) { L.triangularView<Eigen::Lower>().solveInPlace(X); }
void solve_Lt(ConstBlock L, Block X) { L.transpose().triangularView<Eigen::Upper>().solveInPlace(X); }
void solve_Lt_right(ConstBlock L, Block X) {
  L.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(X);
}

}  // namespace manycontact::lq
