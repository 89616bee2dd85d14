#include "dense.hpp"

#include "manycontact/sparse/dense_kernels.hpp"

namespace manycontact::lq {

namespace {

const sparse::DenseKernels& level() { return sparse::dense_kernels(); }
sparse::ConstPanel panel(ConstBlock A) { return {A.data(), A.rows(), A.cols(), A.outerStride()}; }
sparse::Panel panel(Block& A) { return {A.data(), A.rows(), A.cols(), A.outerStride()}; }

}  // namespace

void add_AB(Block C, double a, ConstBlock A, ConstBlock B) { level().add_AB(panel(C), a, panel(A), panel(B)); }
void add_AtB(Block C, double a, ConstBlock A, ConstBlock B) { level().add_AtB(panel(C), a, panel(A), panel(B)); }
void add_ABt(Block C, double a, ConstBlock A, ConstBlock B) { level().add_ABt(panel(C), a, panel(A), panel(B)); }

void add_lower_AB(Block C, double a, ConstBlock A, ConstBlock B) {
  level().add_lower_AB(panel(C), a, panel(A), panel(B));
}
void add_lower_AtB(Block C, double a, ConstBlock A, ConstBlock B) {
  level().add_lower_AtB(panel(C), a, panel(A), panel(B));
}
void add_lower_ABt(Block C, double a, ConstBlock A, ConstBlock B) {
  level().add_lower_ABt(panel(C), a, panel(A), panel(B));
}

void add_Ax(Segment y, double a, ConstBlock A, ConstSegment x) { level().add_Ax(y.data(), a, panel(A), x.data()); }
void add_Atx(Segment y, double a, ConstBlock A, ConstSegment x) { level().add_Atx(y.data(), a, panel(A), x.data()); }

void copy_lower_to_upper(Block C) { C.triangularView<Eigen::StrictlyUpper>() = C.transpose(); }

// The pivots are L_kk^2 = A_kk - sum_j L_kj^2. After the factorization, each is compared with its A_kk.
bool cholesky(Block A, double least) {
  if (A.rows() == 0) return true;
  if (!level().cholesky(panel(A))) return false;
  for (Eigen::Index k = 0; k < A.rows(); ++k) {
    const double pivot = A(k, k) * A(k, k);
    if (!(pivot > least * (pivot + A.row(k).head(k).squaredNorm()))) return false;
  }
  return true;
}

void solve_L(ConstBlock L, Block X) { level().solve_L(panel(L), panel(X)); }
void solve_Lt(ConstBlock L, Block X) { level().solve_Lt(panel(L), panel(X)); }
void solve_Lt_right(ConstBlock L, Block X) { level().solve_Lt_right(panel(L), panel(X)); }

void add_Az(ConstBlock A, const double* z, double* sum, double* scale) { level().add_Az(panel(A), z, sum, scale); }
void add_Az_Atw(ConstBlock A, const double* z, double* sum, double* scale, const double* w, double* sum_t,
                double* scale_t) {
  level().add_Az_Atw(panel(A), z, sum, scale, w, sum_t, scale_t);
}

}  // namespace manycontact::lq
