#include "manycontact/detail/algorithm/frames.hpp"

namespace manycontact {

namespace {

// Returns the frame's placement in its tree frame; on a fixed base, relative to the base's origin, in world axes.
template <class S>
SE3<S> in_tree(const Kinematics<S>& kin, const SE3<double>& base, int joint, const SE3<double>& placement) {
  if (joint >= 0) return kin.oMi[joint] * placement.cast<S>();
  return SE3<S>{base.R.cast<S>(), Vec3<S>::Zero()} * placement.cast<S>();
}

// Returns the placement whose act_inverse converts motions in the tree frame to motions in the requested axes.
template <class S>
SE3<S> view(const Kinematics<S>& kin, int joint, const SE3<S>& M, ReferenceFrame axes) {
  switch (axes) {
    case ReferenceFrame::kLocal:
      return M;
    case ReferenceFrame::kWorld:
      return {Mat3<S>::Identity(), Vec3<S>(-kin.origin(joint))};
    case ReferenceFrame::kLocalWorldAligned:
      return {Mat3<S>::Identity(), M.p};
  }
  return M;
}

}  // namespace

template <class S>
SE3<S> frame_placement(const Kinematics<S>& kin, const SE3<double>& base, int joint, const SE3<double>& placement) {
  SE3<S> M = in_tree<S>(kin, base, joint, placement);
  M.p += joint >= 0 ? kin.origin(joint) : Vec3<S>(base.p.cast<S>());
  return M;
}

template <class S>
Vec6<S> frame_velocity(const Kinematics<S>& kin, const SE3<double>& base, int joint, const SE3<double>& placement,
                       ReferenceFrame axes) {
  if (joint < 0) return Vec6<S>::Zero();
  return view<S>(kin, joint, in_tree<S>(kin, base, joint, placement), axes).act_inverse(kin.v[joint]);
}

template <class S>
Vec6<S> frame_acceleration(const Kinematics<S>& kin, const SE3<double>& base, int joint, const SE3<double>& placement,
                           ReferenceFrame axes) {
  if (joint < 0) return Vec6<S>::Zero();
  return view<S>(kin, joint, in_tree<S>(kin, base, joint, placement), axes)
      .act_inverse(Vec6<S>(kin.a[joint] - kin.a_base));
}

template <class S>
Vec6<S> frame_classical_acceleration(const Kinematics<S>& kin, const SE3<double>& base, int joint,
                                     const SE3<double>& placement, ReferenceFrame axes) {
  Vec6<S> a = frame_acceleration<S>(kin, base, joint, placement, axes);
  const Vec6<S> v = frame_velocity<S>(kin, base, joint, placement, axes);
  a.template head<3>() += Vec3<S>(v.template tail<3>()).cross(Vec3<S>(v.template head<3>()));
  return a;
}

template <class S>
void frame_jacobian(const Model& model, const Kinematics<S>& kin, const SE3<double>& base, int joint,
                    const SE3<double>& placement, ReferenceFrame axes, Mat6XRef<S> J) {
  J.setZero();
  if (joint < 0) return;
  const SE3<S> M = view<S>(kin, joint, in_tree<S>(kin, base, joint, placement), axes);
  const Joint& last = model.joints[joint];
  for (int i = last.idx_v + last.nv() - 1; i >= 0; i = model.dof_parent[i]) J.col(i) = M.act_inverse(kin.J.col(i));
}

using S = InstantiatedScalar;
template SE3<S> frame_placement<S>(const Kinematics<S>&, const SE3<double>&, int, const SE3<double>&);
template Vec6<S> frame_velocity<S>(const Kinematics<S>&, const SE3<double>&, int, const SE3<double>&, ReferenceFrame);
template Vec6<S> frame_acceleration<S>(const Kinematics<S>&, const SE3<double>&, int, const SE3<double>&,
                                       ReferenceFrame);
template Vec6<S> frame_classical_acceleration<S>(const Kinematics<S>&, const SE3<double>&, int, const SE3<double>&,
                                                 ReferenceFrame);
template void frame_jacobian<S>(const Model&, const Kinematics<S>&, const SE3<double>&, int, const SE3<double>&,
                                ReferenceFrame, Mat6XRef<S>);

}  // namespace manycontact
