#include "manycontact/algorithm/crba.hpp"

namespace manycontact {

template <class S>
void crba(const Model& model, const Kinematics<S>& kin, std::vector<Inertia<S>>& Yc, S* M) {
  Yc = kin.Y;
  for (int i = model.njoints() - 1; i >= 0; --i) {
    const Joint& joint = model.joints[i];
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
      const Vec6<S> F = Yc[i] * kin.J.col(k);
      S* row = M + model.M_begin[k];
      for (int j = k; j >= 0; j = model.dof_parent[j]) *row++ = dot(kin.J.col(j), F);  // M_kj = S_j^T Yc S_k
      M[model.M_begin[k]] += S(model.armature[k]);
    }
    if (joint.parent >= 0) Yc[joint.parent] += Yc[i];
  }
}

template <class S>
void unpack_inertia(const Model& model, const S* M, Eigen::Ref<MatX<S>> out) {
  out.setZero();
  for (int i = 0; i < model.nv; ++i) {
    const S* row = M + model.M_begin[i];
    for (int j = i; j >= 0; j = model.dof_parent[j]) out(i, j) = out(j, i) = *row++;
  }
}

template void crba<InstantiatedScalar>(const Model&, const Kinematics<InstantiatedScalar>&,
                                       std::vector<Inertia<InstantiatedScalar>>&, InstantiatedScalar*);
template void unpack_inertia<InstantiatedScalar>(const Model&, const InstantiatedScalar*,
                                                 Eigen::Ref<MatX<InstantiatedScalar>>);

}  // namespace manycontact
