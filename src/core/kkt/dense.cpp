#include "manycontact/kkt/dense.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "manycontact/sparse/condition.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

template <class S>
MatX<S> kkt_matrix(const DenseKkt<S>& kkt) {
  const int nv = kkt.nv(), nc = kkt.nc();
  MatX<S> K(nv + nc, nv + nc);
  K.topLeftCorner(nv, nv) = kkt.M;
  K.topRightCorner(nv, nc) = kkt.J.transpose();
  K.bottomLeftCorner(nc, nv) = kkt.J;
  K.bottomRightCorner(nc, nc) = -kkt.delta * MatX<S>::Identity(nc, nc);
  return K;
}

namespace {

// Determines the rank of J and independent rows by a pivoted QR of J^T, after dividing each row of J by its size.
template <class S>
void decide_rank(DenseKkt<S>& kkt) {
  MatX<S> scaled = kkt.J.transpose();
  for (int k = 0; k < kkt.nc(); ++k) {
    const S own = kkt.nv() > 0 ? kkt.J.row(k).cwiseAbs().maxCoeff() : S(0);
    const S size = kkt.row_scale.size() > 0 ? std::max(own, kkt.row_scale[k]) : own;
    if (size > S(0)) scaled.col(k) /= size;
  }
  kkt.choice.compute(scaled);
  const int most = static_cast<int>(std::min(scaled.rows(), scaled.cols()));
  using std::abs;
  while (kkt.rank < most && abs(kkt.choice.matrixQR()(kkt.rank, kkt.rank)) > S(tolerance::kRank)) ++kkt.rank;
}

template <class S>
void decompose_rows(DenseKkt<S>& kkt) {
  kkt.of_Jt.compute(kkt.J.transpose() * kkt.choice.colsPermutation());
  MatX<S> C = kkt.of_Jt.matrixQR().topRows(kkt.rank);
  for (int k = 0; k < kkt.rank; ++k) C.col(k).tail(kkt.rank - k - 1).setZero();
  const VecX<S> size = C.cwiseAbs().colwise().maxCoeff();
  std::vector<int> order(kkt.nc());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&size](int i, int j) { return size[i] > size[j]; });
  MatX<S> sorted(kkt.nc(), kkt.rank);
  kkt.sorted.resize(kkt.nc());
  for (int k = 0; k < kkt.nc(); ++k) {
    sorted.row(k) = C.col(order[k]).transpose();
    kkt.sorted.indices()[kkt.choice.colsPermutation().indices()[order[k]]] = k;
  }
  if (kkt.of_Ct.cols() != kkt.rank)  // not resized, for the reason given in `factor`
    kkt.of_Ct = Eigen::ColPivHouseholderQR<MatX<S>>(kkt.nc(), kkt.rank);
  kkt.of_Ct.compute(sorted);
}

// Whether a pivot is at most the rounding error of the terms from which it is computed.
template <class S>
bool is_noise(const S& pivot, const S& terms, int rounding = tolerance::kRounding) {
  using std::abs;
  return !(abs(pivot) > S(rounding) * std::numeric_limits<S>::epsilon() * terms);
}

// Whether A = N^T M N (N: basis of J's null space) has a sound factor. Its pivots must exceed the rounding errors of
// |N|^T |M| |N|, and the effect of N's errors.
template <class S>
bool sound_inertia(const DenseKkt<S>& kkt, const MatX<S>& A) {
  const MatX<S>&M = kkt.M, &N = kkt.N;
  const Eigen::LLT<MatX<S>>& llt = kkt.reduced;
  if (llt.info() != Eigen::Success) return false;
  const MatX<S> size_M = M.cwiseAbs(), size_N = N.cwiseAbs(), terms = size_N.transpose() * (size_M * size_N);
  const S of_N = S(tolerance::kRounding) * std::numeric_limits<S>::epsilon();
  const VecX<S> sums = size_M.rowwise().sum();
  const S sum = sums.sum();
  for (int k = 0; k < A.rows(); ++k) {
    const S l = llt.matrixLLT()(k, k);
    if (is_noise<S>(l * l, terms(k, k)) || !(l * l > of_N * (S(2) * size_N.col(k).dot(sums) + of_N * sum)))
      return false;
  }
  // Without pivoting, a small pivot may enlarge errors of later pivots. The condition number shows this.
  const double inverse = sparse::inverse_norm_1(static_cast<int>(A.rows()), [&llt](double* x) {
    Eigen::Map<Eigen::VectorXd> y(x, llt.rows());
    y = llt.solve(y.template cast<S>()).template cast<double>();
  });
  const S norm = A.cwiseAbs().colwise().sum().maxCoeff();
  return S(tolerance::kRounding) * std::numeric_limits<S>::epsilon() * norm * S(inverse) < S(1);
}

template <class S>
bool sound_damped(const DenseKkt<S>& kkt) {
  const MatX<S>& LU = kkt.lu.matrixLU();
  for (int k = 0; k < LU.rows(); ++k) {
    const S terms = LU.row(k).head(k).cwiseAbs() * LU.col(k).head(k).cwiseAbs();
    if (is_noise<S>(LU(k, k), terms, tolerance::kDampingRounding)) return false;
  }
  return true;
}

template <class S>
void solve_once(const DenseKkt<S>& kkt, const MatX<S>& b1, const MatX<S>& b2, MatX<S>& a, MatX<S>& f) {
  const int nv = kkt.nv(), nc = kkt.nc();
  if (kkt.delta > S(0)) {
    MatX<S> b(nv + nc, b1.cols());
    b << b1, b2;
    const MatX<S> x = kkt.lu.solve(b);  // [a; -f]
    a = x.topRows(nv);
    f = -x.bottomRows(nc);
    return;
  }
  a = kkt.motion(b2);
  if (kkt.N.cols() > 0) a += kkt.N * kkt.reduced.solve(kkt.N.transpose() * (b1 - kkt.M * a));
  f = kkt.force(kkt.M * a - b1);
}

}  // namespace

template <class S>
MatX<S> DenseKkt<S>::motion(const MatX<S>& b) const {
  if (rank == 0) return MatX<S>::Zero(nv(), b.cols());
  MatX<S> y = sorted * b, a = MatX<S>::Zero(nv(), b.cols());
  y.applyOnTheLeft(of_Ct.householderQ().transpose());
  const auto T = of_Ct.matrixQR().topLeftCorner(rank, rank).template triangularView<Eigen::Upper>();
  a.topRows(rank) = of_Ct.colsPermutation() * MatX<S>(T.solve(y.topRows(rank)));
  a.applyOnTheLeft(of_Jt.householderQ());
  return a;
}

template <class S>
MatX<S> DenseKkt<S>::force(const MatX<S>& g) const {
  if (rank == 0) return MatX<S>::Zero(nc(), g.cols());
  MatX<S> z = g, y = MatX<S>::Zero(nc(), g.cols());
  z.applyOnTheLeft(of_Jt.householderQ().transpose());
  const auto T = of_Ct.matrixQR().topLeftCorner(rank, rank).template triangularView<Eigen::Upper>();
  y.topRows(rank) = T.transpose().solve(of_Ct.colsPermutation().transpose() * z.topRows(rank));
  y.applyOnTheLeft(of_Ct.householderQ());
  return sorted.transpose() * y;
}

template <class S>
void factor(DenseKkt<S>& kkt) {
  const int nv = kkt.nv(), nc = kkt.nc();
  kkt.rank = 0;
  kkt.holds = kkt.regular = false;
  if (!kkt.M.allFinite() || !kkt.J.allFinite()) return;
  if (nc > 0) {
    decide_rank(kkt);
    if (kkt.rank > 0) decompose_rows(kkt);
  }
  // N and reduced are constructed again, as a failing resize of Eigen leaves a freed array.
  if (kkt.N.cols() != nv - kkt.rank) {
    kkt.N = MatX<S>();
    kkt.reduced = Eigen::LLT<MatX<S>>(MatX<S>::Identity(nv - kkt.rank, nv - kkt.rank));
  }
  kkt.N.setZero(nv, nv - kkt.rank);
  kkt.regular = true;
  if (kkt.N.cols() > 0) {
    kkt.N.bottomRows(nv - kkt.rank).setIdentity();
    if (kkt.rank > 0) kkt.N.applyOnTheLeft(kkt.of_Jt.householderQ());
    const MatX<S> A = kkt.N.transpose() * (kkt.M * kkt.N);
    kkt.reduced.compute(A);
    kkt.regular = sound_inertia<S>(kkt, A);
  }
  kkt.holds = kkt.regular;
  if (kkt.regular && kkt.delta > S(0)) {
    kkt.lu.compute(kkt_matrix(kkt));
    kkt.regular = sound_damped<S>(kkt);
  }
}

template <class S>
void solve(const DenseKkt<S>& kkt, const MatX<S>& b1, const MatX<S>& b2, MatX<S>& a, MatX<S>& f) {
  if (!kkt.regular) {
    a.setConstant(kkt.nv(), b1.cols(), std::numeric_limits<S>::quiet_NaN());
    f.setConstant(kkt.nc(), b1.cols(), std::numeric_limits<S>::quiet_NaN());
    return;
  }
  solve_once<S>(kkt, b1, b2, a, f);
  // r2 contains the least-squares residual, which is orthogonal to J's range and has no effect on da and df.
  const MatX<S> r1 = b1 - kkt.M * a + kkt.J.transpose() * f, r2 = b2 - kkt.J * a - kkt.delta * f;
  MatX<S> da, df;
  solve_once<S>(kkt, r1, r2, da, df);
  a += da;
  f += df;
}

using Real = InstantiatedScalar;
template struct DenseKkt<Real>;
template void factor<Real>(DenseKkt<Real>&);
template void solve<Real>(const DenseKkt<Real>&, const MatX<Real>&, const MatX<Real>&, MatX<Real>&, MatX<Real>&);
template MatX<Real> kkt_matrix<Real>(const DenseKkt<Real>&);

}  // namespace manycontact
