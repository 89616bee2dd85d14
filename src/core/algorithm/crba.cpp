#include "manycontact/detail/algorithm/crba.hpp"

#include "manycontact/algorithm/model_numbers.hpp"

namespace manycontact {

namespace {

// Computes the composite inertias Yc and the packed M, with its entry k at the reference M(k).
template <class S, class Entries>
void composite_inertias(const Model& model, const Kinematics<S>& kin, std::vector<Inertia<S>>& Yc, const Entries& M) {
  Yc.resize(kin.Y.size());
  for (int i = model.njoints() - 1; i >= 0; --i) {
    const Joint& joint = model.joints[i];
    if (model.subtree_end[i] == i + 1) Yc[i] = kin.Y[i];
    const int first = model.floating_base && i > 0 ? 6 : 0;
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
      const Vec6<S> F = Yc[i] * kin.J.col(k);
      int at = model.M_begin[k];
      for (int j = k; j >= first; j = model.dof_parent[j]) M(at++) = dot(kin.J.col(j), F);  // M_kj = S_j^T Yc S_k
      if (first > 0) {  // entries of the floating base, whose S is diag(R, R), as it is at the tree frame's origin
        const Vec3<S> moment = transpose_times<S>(kin.oMi[0].R, F.template tail<3>());
        const Vec3<S> force = transpose_times<S>(kin.oMi[0].R, F.template head<3>());
        for (int j : {2, 1, 0}) M(at++) = moment[j];
        for (int j : {2, 1, 0}) M(at++) = force[j];
      }
      M(model.M_begin[k]) += armature_of<S>(model, kin.own, k);
    }
    if (joint.parent < 0) continue;
    Inertia<S>& above = Yc[joint.parent];
    // The parent's last child comes first and initialises the parent's composite inertia.
    if (model.subtree_end[i] == model.subtree_end[joint.parent]) above = kin.Y[joint.parent];
    above += Yc[i];
  }
}

}  // namespace

template <class S>
void crba(const Model& model, const Kinematics<S>& kin, std::vector<Inertia<S>>& Yc, S* M) {
  composite_inertias<S>(model, kin, Yc, [M](int k) -> S& { return M[k]; });
}

template <class S>
void crba(const Model& model, const Kinematics<S>& kin, std::vector<Inertia<S>>& Yc, const int* slot, S* M) {
  composite_inertias<S>(model, kin, Yc, [M, slot](int k) -> S& { return M[slot[k]]; });
}

template <class S>
void unpack_inertia(const Model& model, const S* M, MatRef<S> out) {
  out.setZero();
  for (int i = 0; i < model.nv; ++i) {
    const S* row = M + model.M_begin[i];
    for (int j = i; j >= 0; j = model.dof_parent[j]) out(i, j) = out(j, i) = *row++;
  }
}

using Real = InstantiatedScalar;
template void crba<Real>(const Model&, const Kinematics<Real>&, std::vector<Inertia<Real>>&, Real*);
template void crba<Real>(const Model&, const Kinematics<Real>&, std::vector<Inertia<Real>>&, const int*, Real*);
template void unpack_inertia<Real>(const Model&, const Real*, MatRef<Real>);

}  // namespace manycontact
