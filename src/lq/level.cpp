// Dense blocks at one level of instructions: compiled once per level with that level's flags and MANYCONTACT_LEVEL (its
// name). Nothing of it but the level is seen by the linker (src/lanes.cmake).

#include <Eigen/Cholesky>
#include <cmath>

#include "dense_level.hpp"
#include "manycontact/sparse/instruction_levels.hpp"

namespace manycontact::lq {
namespace {

using Eigen::MatrixXd;
using Strided = Eigen::OuterStride<>;
using Map = Eigen::Map<MatrixXd, 0, Strided>;
using ConstMap = Eigen::Map<const MatrixXd, 0, Strided>;

Map map(Panel M) { return {M.entries, M.rows, M.cols, Strided(M.stride)}; }
ConstMap map(ConstPanel M) { return {M.entries, M.rows, M.cols, Strided(M.stride)}; }

// Eigen's product into a triangle divides by zero where there is nothing to multiply.
bool nothing(Panel C, ConstPanel A) { return C.rows == 0 || A.rows == 0 || A.cols == 0; }

void add_AB(Panel C, double a, ConstPanel A, ConstPanel B) { map(C).noalias() += a * map(A) * map(B); }
void add_AtB(Panel C, double a, ConstPanel A, ConstPanel B) { map(C).noalias() += a * map(A).transpose() * map(B); }
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
  Map x = map(X);
  map(L).triangularView<Eigen::Lower>().solveInPlace(x);
}
void solve_Lt(ConstPanel L, Panel X) {
  Map x = map(X);
  map(L).transpose().triangularView<Eigen::Upper>().solveInPlace(x);
}
void solve_Lt_right(ConstPanel L, Panel X) {
  Map x = map(X);
  map(L).transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(x);
}

using Vector = Eigen::Map<Eigen::VectorXd>;
using ConstVector = Eigen::Map<const Eigen::VectorXd>;

void add_Az(ConstPanel A, const double* z, double* sum, double* scale) {
  Vector y(sum, A.rows), size(scale, A.rows);
  for (Eigen::Index j = 0; j < A.cols; ++j) {
    const ConstVector column(A.entries + j * A.stride, A.rows);
    y += z[j] * column;
    size += std::abs(z[j]) * column.cwiseAbs();
  }
}
void add_Az_Atw(ConstPanel A, const double* z, double* sum, double* scale, const double* w, double* sum_t,
                double* scale_t) {
  Vector y(sum, A.rows), size(scale, A.rows);
  const ConstVector along(w, A.rows);
  for (Eigen::Index j = 0; j < A.cols; ++j) {
    const ConstVector column(A.entries + j * A.stride, A.rows);
    y += z[j] * column;
    size += std::abs(z[j]) * column.cwiseAbs();
    sum_t[j] += column.dot(along);
    scale_t[j] += column.cwiseAbs().dot(along.cwiseAbs());
  }
}

}  // namespace

extern const DenseLevel MANYCONTACT_OF_LEVEL(dense_level_);
const DenseLevel MANYCONTACT_OF_LEVEL(dense_level_) = {add_AB,        add_AtB,        add_ABt,  add_lower_AB,
                                                       add_lower_AtB, add_lower_ABt,  cholesky, solve_L,
                                                       solve_Lt,      solve_Lt_right, add_Az,   add_Az_Atw};

}  // namespace manycontact::lq
