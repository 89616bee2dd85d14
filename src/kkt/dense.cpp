#include "manycontact/kkt/dense.hpp"

#include <algorithm>
#include <limits>

#include "manycontact/sparse/condition.hpp"
#include "manycontact/sparse/refine.hpp"
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

// A pivot that is no more than rounding of the terms it was computed from.
template <class S>
bool is_noise(const S& pivot, const S& terms, int rounding = tolerance::kRounding) {
  using std::abs;
  return !(abs(pivot) > S(rounding) * std::numeric_limits<S>::epsilon() * terms);
}

template <class S>
bool sound(const Eigen::LLT<MatX<S>>& llt, const MatX<S>& A) {
  if (llt.info() != Eigen::Success) return false;
  for (int k = 0; k < A.rows(); ++k) {
    const S l = llt.matrixLLT()(k, k);
    if (is_noise<S>(l * l, A(k, k))) return false;
  }
  // Without pivoting, noise can pass on from a poor pivot to the next and grow: the condition shows it.
  const double inverse = sparse::inverse_norm_1(static_cast<int>(A.rows()), [&llt](double* x) {
    Eigen::Map<Eigen::VectorXd> y(x, llt.rows());
    y = llt.solve(y.template cast<S>()).template cast<double>();
  });
  const S norm = A.cwiseAbs().colwise().sum().maxCoeff();
  return S(tolerance::kRounding) * std::numeric_limits<S>::epsilon() * norm * S(inverse) < S(1);
}

template <class S>
bool sound(const Eigen::PartialPivLU<MatX<S>>& lu) {
  const MatX<S>& LU = lu.matrixLU();
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
  if (nc > 0)
    a = kkt.cod.transpose().solve(b2);  // J^+ b2
  else
    a = MatX<S>::Zero(nv, b1.cols());
  if (kkt.N.cols() > 0) a += kkt.N * kkt.reduced.solve(kkt.N.transpose() * (b1 - kkt.M * a));
  if (nc > 0)
    f = kkt.cod.solve(kkt.M * a - b1);
  else
    f = MatX<S>::Zero(0, b1.cols());
}

}  // namespace

template <class S>
void factor(DenseKkt<S>& kkt) {
  const int nv = kkt.nv(), nc = kkt.nc();
  kkt.rank = 0;
  kkt.holds = kkt.regular = false;
  if (!kkt.M.allFinite() || !kkt.J.allFinite()) return;
  if (nc > 0) {
    S largest(0);  // column of J^T, which the first pivot is
    for (int k = 0; k < nc; ++k) largest = std::max(largest, S(kkt.J.row(k).norm()));
    S threshold(tolerance::kRank);
    if (kkt.J_size > largest) threshold *= largest > S(0) ? S(kkt.J_size / largest) : S(1);
    kkt.cod.setThreshold(threshold);
    kkt.cod.compute(kkt.J.transpose());
    kkt.rank = static_cast<int>(kkt.cod.rank());
  }
  MatX<S> Q = MatX<S>::Identity(nv, nv);
  if (nc > 0) Q = kkt.cod.matrixQ() * Q;
  // A change of rank makes these anew: where memory runs out, Eigen's own resize leaves an array freed.
  if (kkt.N.cols() != nv - kkt.rank) {
    kkt.N = MatX<S>();
    kkt.reduced = Eigen::LLT<MatX<S>>(MatX<S>::Identity(nv - kkt.rank, nv - kkt.rank));
  }
  kkt.N = Q.rightCols(nv - kkt.rank);
  kkt.regular = true;
  if (kkt.N.cols() > 0) {
    const MatX<S> MN = kkt.M * kkt.N, A = kkt.N.transpose() * MN;
    kkt.reduced.compute(A);
    kkt.regular = sound<S>(kkt.reduced, A);
    // What N's own rounding makes of M where M has nothing.
    for (int k = 0; k < A.rows(); ++k) kkt.regular = kkt.regular && !is_noise<S>(A(k, k), MN.col(k).cwiseAbs().sum());
  }
  kkt.holds = kkt.regular;
  if (kkt.regular && kkt.delta > S(0)) {
    kkt.lu.compute(kkt_matrix(kkt));
    kkt.regular = sound<S>(kkt.lu);
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
  // What least squares leaves of r2 is orthogonal to J's range and changes nothing.
  MatX<S> r1, r2, da, df;
  sparse::refine_unjudged(
      1,
      [&] {
        r1 = b1 - kkt.M * a + kkt.J.transpose() * f;
        r2 = b2 - kkt.J * a - kkt.delta * f;
      },
      [&] {
        solve_once<S>(kkt, r1, r2, da, df);
        a += da;
        f += df;
      });
}

template struct DenseKkt<InstantiatedScalar>;
template void factor<InstantiatedScalar>(DenseKkt<InstantiatedScalar>&);
template void solve<InstantiatedScalar>(const DenseKkt<InstantiatedScalar>&, const MatX<InstantiatedScalar>&,
                                        const MatX<InstantiatedScalar>&, MatX<InstantiatedScalar>&,
                                        MatX<InstantiatedScalar>&);
template MatX<InstantiatedScalar> kkt_matrix<InstantiatedScalar>(const DenseKkt<InstantiatedScalar>&);

}  // namespace manycontact
