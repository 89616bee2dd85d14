#include "stability/condition.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <limits>

namespace manycontact::test {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class S>
MatX<S> kkt(const MatX<S>& M, const MatX<S>& J, const MatX<S>& lower_right) {
  const Eigen::Index nv = M.rows(), nc = J.rows();
  MatX<S> K(nv + nc, nv + nc);
  K.topLeftCorner(nv, nv) = M;
  K.topRightCorner(nv, nc) = J.transpose();
  K.bottomLeftCorner(nc, nv) = J;
  K.bottomRightCorner(nc, nc) = lower_right;
  return K;
}

template <class S>
double norm_1(const MatX<S>& A) {
  return static_cast<double>(S(A.cwiseAbs().colwise().sum().maxCoeff()));
}

// Returns an orthonormal basis of the null space of J^T for J of the given rank.
template <class S>
MatX<S> null_space(const MatX<S>& J, int rank) {
  const Eigen::ColPivHouseholderQR<MatX<S>> qr(J);
  const MatX<S> Q = qr.householderQ() * MatX<S>::Identity(J.rows(), J.rows());
  return Q.rightCols(J.rows() - rank);
}

// Z spans the null space of J^T, and J <- J - Z Z^T J removes rounding errors from it:
//
//   [M J^T; J -Z Z^T]^-1 = K^+ - [0 0; 0 Z Z^T]
//
// since K is zero on [0; Z] and -Z Z^T is -I there.
template <class S>
Condition condition_in(const IslandSystem<Quad>& system, double delta, int rank) {
  const MatX<S> M = system.M.template cast<S>();
  MatX<S> J = system.J.template cast<S>();
  const Eigen::Index nc = J.rows();
  if (delta > 0 || rank == nc) {
    const MatX<S> K = kkt<S>(M, J, -S(delta) * MatX<S>::Identity(nc, nc));
    return {norm_1<S>(K), norm_1<S>(K.partialPivLu().inverse())};
  }
  const MatX<S> Z = null_space<S>(J, rank), ZZ = Z * Z.transpose();
  J -= ZZ * J;
  MatX<S> inverse = kkt<S>(M, J, -ZZ).partialPivLu().inverse();
  inverse.bottomRightCorner(nc, nc) += ZZ;
  return {norm_1<S>(kkt<S>(M, J, MatX<S>::Zero(nc, nc))), norm_1<S>(inverse)};
}

}  // namespace

Condition condition(const IslandSystem<Quad>& system, double delta, int rank) {
  if (!system.M.allFinite() || !system.J.allFinite()) return {kInfinity, kInfinity};
  // The inverse loses as many digits as the condition has. Those of long double suffice for most.
  const auto good = [](const Condition& c, double eps) { return c.product() * eps < 1e-3; };
  Condition c = condition_in<long double>(system, delta, rank);
  if (good(c, static_cast<double>(std::numeric_limits<long double>::epsilon()))) return c;
  c = condition_in<Quad>(system, delta, rank);
  if (good(c, static_cast<double>(std::numeric_limits<Quad>::epsilon()))) return c;
  return {c.K, kInfinity};
}

Condition estimated_condition(const IslandSystem<double>& system, double delta) {
  const Eigen::Index nc = system.J.rows();
  const MatX<double> K = kkt<double>(system.M, system.J, -delta * MatX<double>::Identity(nc, nc));
  if (!K.allFinite()) return {kInfinity, kInfinity};
  const double norm = norm_1<double>(K), reciprocal = K.partialPivLu().rcond();
  return {norm, reciprocal > 0 ? 1 / (reciprocal * norm) : kInfinity};
}

}  // namespace manycontact::test
