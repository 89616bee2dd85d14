// Dense kernels of one SIMD level. The build compiles this file once per level, with the level's compiler flags and its
// name as MANYCONTACT_LEVEL. Only the table of kernels is visible to the linker (src/core/simd/levels.cmake).

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "manycontact/sparse/dense_kernels.hpp"
#include "simd/levels.hpp"

namespace manycontact::sparse {
namespace {

using Eigen::MatrixXd;
using Strided = Eigen::OuterStride<>;
using Map = Eigen::Map<MatrixXd, 0, Strided>;
using ConstMap = Eigen::Map<const MatrixXd, 0, Strided>;

Map map(Panel M) { return {M.entries, M.rows, M.cols, Strided(M.stride)}; }
ConstMap map(ConstPanel M) { return {M.entries, M.rows, M.cols, Strided(M.stride)}; }

// Whether operands are empty: Eigen's triangular product would divide by zero, its triangular solve read entry 0.
bool nothing(Panel C, ConstPanel A) { return C.rows == 0 || A.rows == 0 || A.cols == 0; }
bool nothing(Panel X) { return X.rows == 0 || X.cols == 0; }

// C += a A B. If C is a single row, its entries are not contiguous, and Eigen's product would allocate memory.
void add_AB(Panel C, double a, ConstPanel A, ConstPanel B) {
  if (C.rows == 1)
    map(C) += a * map(A).lazyProduct(map(B));
  else
    map(C).noalias() += a * map(A) * map(B);
}
void add_AtB(Panel C, double a, ConstPanel A, ConstPanel B) {
  if (C.rows == 1)
    map(C) += a * map(A).transpose().lazyProduct(map(B));
  else
    map(C).noalias() += a * map(A).transpose() * map(B);
}
void add_ABt(Panel C, double a, ConstPanel A, ConstPanel B) { map(C).noalias() += a * map(A) * map(B).transpose(); }
void add_lower_AB(Panel C, double a, ConstPanel A, ConstPanel B) {
  if (!nothing(C, A)) map(C).triangularView<Eigen::Lower>() += a * map(A) * map(B);
}
void add_lower_AtB(Panel C, double a, ConstPanel A, ConstPanel B) {
  if (!nothing(C, A)) map(C).triangularView<Eigen::Lower>() += a * map(A).transpose() * map(B);
}
void add_lower_ABt(Panel C, double a, ConstPanel A, ConstPanel B) {
  if (!nothing(C, A)) map(C).triangularView<Eigen::Lower>() += a * map(A) * map(B).transpose();
}

bool cholesky(Panel A) {
  Eigen::Ref<MatrixXd> in_place = map(A);
  return Eigen::LLT<Eigen::Ref<MatrixXd>>(in_place).info() == Eigen::Success;
}
void solve_L(ConstPanel L, Panel X) {
  if (nothing(X)) return;
  Map x = map(X);
  map(L).triangularView<Eigen::Lower>().solveInPlace(x);
}
void solve_Lt(ConstPanel L, Panel X) {
  if (nothing(X)) return;
  Map x = map(X);
  map(L).transpose().triangularView<Eigen::Upper>().solveInPlace(x);
}
void solve_Lt_right(ConstPanel L, Panel X) {
  if (nothing(X)) return;
  Map x = map(X);
  map(L).transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(x);
}

using Vector = Eigen::Map<Eigen::VectorXd>;
using ConstVector = Eigen::Map<const Eigen::VectorXd>;

void add_Ax(double* y, double a, ConstPanel A, const double* x) {
  Vector(y, A.rows).noalias() += a * map(A) * ConstVector(x, A.cols);
}
void add_Atx(double* y, double a, ConstPanel A, const double* x) {
  Vector(y, A.cols).noalias() += a * map(A).transpose() * ConstVector(x, A.rows);
}

// sum += A z, scale += |A| |z|. Adds four columns at a time, so that sums are loaded and stored a quarter as often.
void add_Az(ConstPanel A, const double* z, double* sum, double* scale) {
  Vector y(sum, A.rows), size(scale, A.rows);
  const auto column = [&](Eigen::Index j) { return ConstVector(A.entries + j * A.stride, A.rows); };
  Eigen::Index j = 0;
  for (; j + 4 <= A.cols; j += 4) {
    const ConstVector a = column(j), b = column(j + 1), c = column(j + 2), d = column(j + 3);
    y += z[j] * a + z[j + 1] * b + z[j + 2] * c + z[j + 3] * d;
    size += std::abs(z[j]) * a.cwiseAbs() + std::abs(z[j + 1]) * b.cwiseAbs() + std::abs(z[j + 2]) * c.cwiseAbs() +
            std::abs(z[j + 3]) * d.cwiseAbs();
  }
  for (; j < A.cols; ++j) {
    y += z[j] * column(j);
    size += std::abs(z[j]) * column(j).cwiseAbs();
  }
}
void add_Az_Atw(ConstPanel A, const double* z, double* sum, double* scale, const double* w, double* sum_t,
                double* scale_t) {
  const ConstVector along(w, A.rows);
  for (Eigen::Index j = 0; j < A.cols; j += 4) {
    const Eigen::Index end = std::min<Eigen::Index>(j + 4, A.cols);
    add_Az({A.entries + j * A.stride, A.rows, end - j, A.stride}, z + j, sum, scale);
    for (Eigen::Index i = j; i < end; ++i) {
      const ConstVector column(A.entries + i * A.stride, A.rows);
      sum_t[i] += column.dot(along);
      scale_t[i] += column.cwiseAbs().dot(along.cwiseAbs());
    }
  }
}

}  // namespace

extern const DenseKernels MANYCONTACT_OF_LEVEL(blocks_level_);
const DenseKernels MANYCONTACT_OF_LEVEL(blocks_level_) = {add_AB,        add_AtB,  add_ABt, add_lower_AB, add_lower_AtB,
                                                   add_lower_ABt, cholesky, solve_L, solve_Lt,     solve_Lt_right,
                                                   add_Ax,        add_Atx,  add_Az,  add_Az_Atw};

}  // namespace manycontact::sparse
