#include "manycontact/detail/algorithm/rnea.hpp"

namespace manycontact {

template <class S>
void inverse_dynamics(const Model& model, const Kinematics<S>& kin, const S* qdd, std::span<const Vec6<S>> fext,
                      std::vector<Vec6<S>>& f, VecRef<S> tau) {
  const int n = model.njoints();
  f.resize(n);
  for (int i = 0; i < n; ++i) {
    f[i] = add_cross_force(kin.Y[i] * kin.a[i], kin.v[i], kin.Y[i] * kin.v[i]);  // f = Y a + v x* Y v
    if (!fext.empty()) f[i] -= fext[i];
  }
  for (int i = n - 1; i >= 0; --i) {
    const Joint& joint = model.joints[i];
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) tau[k] = dot(kin.J.col(k), f[i]);  // tau = S^T f
    if (joint.parent >= 0) f[joint.parent] += f[i];
  }
  if (qdd)
    for (int k = 0; k < model.nv; ++k) tau[k] += S(model.armature[k]) * qdd[k];
}

template <class S>
void rnea(const Model& model, const SE3<double>& base, const ConstVecRef<S>& q, const ConstVecRef<S>& v,
          const ConstVecRef<S>& qdd, const Vec3<double>& gravity, std::span<const Vec6<S>> fext, Kinematics<S>& kin,
          std::vector<Vec6<S>>& f, VecRef<S> tau) {
  forward_kinematics<S>(model, base, q, kin);
  forward_accelerations<S>(model, v, qdd.data(), gravity, kin);
  if (fext.empty()) {
    inverse_dynamics<S>(model, kin, qdd.data(), {}, f, tau);
    return;
  }
  std::vector<Vec6<S>> in_tree(fext.size());
  for (std::size_t i = 0; i < fext.size(); ++i) in_tree[i] = kin.oMi[i].act_force(fext[i]);
  inverse_dynamics<S>(model, kin, qdd.data(), in_tree, f, tau);
}

using Real = InstantiatedScalar;
template void inverse_dynamics<Real>(const Model&, const Kinematics<Real>&, const Real*, std::span<const Vec6<Real>>,
                                     std::vector<Vec6<Real>>&, VecRef<Real>);
template void rnea<Real>(const Model&, const SE3<double>&, const ConstVecRef<Real>&, const ConstVecRef<Real>&,
                         const ConstVecRef<Real>&, const Vec3<double>&, std::span<const Vec6<Real>>, Kinematics<Real>&,
                         std::vector<Vec6<Real>>&, VecRef<Real>);

}  // namespace manycontact
