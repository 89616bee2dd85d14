#include "manycontact/algorithm/aba.hpp"

#include <Eigen/Cholesky>
#include <limits>

namespace manycontact {

template <class S>
AbaData<S>::AbaData(const Model& model)
    : IA(model.njoints()),
      pA(model.njoints()),
      U(6, model.nv),
      u(model.nv),
      Dinv(model.njoints(), Mat6<S>::Zero()),
      a(model.njoints()) {}

namespace {

// Backward step for joint i with N coordinates: U = IA S, D = S^T U + armature, u = tau - S^T pA. Adds IA - U D^-1 U^T
// and pA + U D^-1 u to the parent's IA and pA. kin.a has the bias accelerations. Returns false unless D > 0 (N = 1: and
// above its rounding error).
template <class S, int N>
bool eliminate(const Model& model, const Joint& joint, int i, const Kinematics<S>& kin, AbaData<S>& d) {
  const int iv = joint.idx_v;
  const auto J = kin.J.template middleCols<N>(iv);
  auto U = d.U.template middleCols<N>(iv);
  U.noalias() = d.IA[i] * J;
  Eigen::Matrix<S, N, N> D = J.transpose() * U;
  for (int k = 0; k < N; ++k) D(k, k) += S(model.armature[iv + k]);
  d.u.template segment<N>(iv).noalias() -= J.transpose() * d.pA[i];
  if constexpr (N == 1) {
    const S noise = S(16) * std::numeric_limits<S>::epsilon() * (J.cwiseAbs().col(0).dot(U.cwiseAbs().col(0)));
    if (!(D(0, 0) > noise)) return false;
    d.Dinv[i](0, 0) = S(1) / D(0, 0);
  } else {
    const Eigen::LLT<Eigen::Matrix<S, N, N>> llt(D);
    if (llt.info() != Eigen::Success) return false;
    d.Dinv[i].template topLeftCorner<N, N>() = llt.solve(Eigen::Matrix<S, N, N>::Identity());
  }
  if (joint.parent < 0) return true;
  const Eigen::Matrix<S, 6, N> UD = U * d.Dinv[i].template topLeftCorner<N, N>();
  d.IA[i].noalias() -= UD * U.transpose();
  Vec6<S> pa = d.pA[i];
  pa.noalias() += UD * d.u.template segment<N>(iv);
  d.IA[joint.parent] += d.IA[i];
  d.pA[joint.parent] += pa;
  return true;
}

// Forward step for joint i: qdd = D^-1 (u - U^T a'), a = a' + S qdd. On entry, d.a[i] is a', the parent's a.
template <class S, int N>
void accelerate(const Joint& joint, int i, const Kinematics<S>& kin, AbaData<S>& d, VecRef<S>& qdd) {
  const int iv = joint.idx_v;
  Eigen::Matrix<S, N, 1> r = d.u.template segment<N>(iv);
  r.noalias() -= d.U.template middleCols<N>(iv).transpose() * d.a[i];
  qdd.template segment<N>(iv).noalias() = d.Dinv[i].template topLeftCorner<N, N>() * r;
  d.a[i].noalias() += kin.J.template middleCols<N>(iv) * qdd.template segment<N>(iv);
}

}  // namespace

template <class S>
bool aba(const Model& model, const SE3<double>& base, const ConstVecRef<S>& q, const ConstVecRef<S>& v,
         const ConstVecRef<S>& tau, const Vec3<double>& gravity, std::span<const Vec6<S>> fext, Kinematics<S>& kin,
         AbaData<S>& d, VecRef<S> qdd) {
  forward_kinematics<S>(model, base, q, kin);
  forward_accelerations<S>(model, v, nullptr, gravity, kin);  // kin.a: accelerations for qdd = 0, bias included
  const int n = model.njoints();
  d.u = tau;
  // Accelerations are kin.a + a', with a' = 0 at the base; bias forces are then those of RNEA for qdd = 0.
  for (int i = 0; i < n; ++i) {
    d.IA[i] = kin.Y[i].matrix();
    d.pA[i] = add_cross_force(kin.Y[i] * kin.a[i], kin.v[i], kin.Y[i] * kin.v[i]);
    if (!fext.empty()) d.pA[i] -= kin.oMi[i].act_force(fext[i]);
  }
  for (int i = n - 1; i >= 0; --i) {
    const Joint& joint = model.joints[i];
    const bool positive = joint.nv() == 1   ? eliminate<S, 1>(model, joint, i, kin, d)
                          : joint.nv() == 3 ? eliminate<S, 3>(model, joint, i, kin, d)
                                            : eliminate<S, 6>(model, joint, i, kin, d);
    if (!positive) {
      qdd.setConstant(std::numeric_limits<S>::quiet_NaN());
      return false;
    }
  }
  for (int i = 0; i < n; ++i) {
    const Joint& joint = model.joints[i];
    d.a[i] = joint.parent < 0 ? Vec6<S>(Vec6<S>::Zero()) : d.a[joint.parent];
    if (joint.nv() == 1)
      accelerate<S, 1>(joint, i, kin, d, qdd);
    else if (joint.nv() == 3)
      accelerate<S, 3>(joint, i, kin, d, qdd);
    else
      accelerate<S, 6>(joint, i, kin, d, qdd);
  }
  return true;
}

using Real = InstantiatedScalar;
template struct AbaData<Real>;
template bool aba<Real>(const Model&, const SE3<double>&, const ConstVecRef<Real>&, const ConstVecRef<Real>&,
                        const ConstVecRef<Real>&, const Vec3<double>&, std::span<const Vec6<Real>>, Kinematics<Real>&,
                        AbaData<Real>&, VecRef<Real>);

}  // namespace manycontact
