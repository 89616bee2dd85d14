#include "manycontact/algorithm/body_kinematics.hpp"

#include <algorithm>
#include <array>

#include "place_path.hpp"

namespace manycontact {

template <class S>
BodyKinematics<S>::BodyKinematics(const Model& model)
    : origins(model.trees.size()), R(model.njoints()), p(model.njoints()), v(model.njoints()), tree_of(model.tree_of) {}

namespace {

// Moves the axes R and origin r of a joint frame to the child frame at q. Sets the nonzero entries of J, the joint's
// motion subspace about the child frame's origin.
template <class S>
void move_body(const Joint& joint, const ConstVecRef<S>& q, Mat3<S>& R, Vec3<S>& r, Eigen::Map<Mat6X<S>>& J) {
  S s, c;
  sin_cos(angle_of<S>(joint, q), s, c);
  move_frame<S>(joint, q, s, c, R, r);
  switch (joint.type) {
    case JointType::kRevolute:
      J.col(0).template tail<3>() = axis_of<S>(joint, R);
      break;
    case JointType::kPrismatic:
      J.col(0).template head<3>() = axis_of<S>(joint, R);
      break;
    case JointType::kFloating:
      J.template block<3, 3>(0, 0) = R;
      J.template block<3, 3>(3, 3) = R;
      break;
    case JointType::kPlanar:
      J.col(0).template head<3>() = R.col(0);
      J.col(1).template head<3>() = R.col(1);
      J.col(2).template tail<3>() = R.col(2);
      break;
  }
}

template <class S>
Vec6<S> joint_motion(const Joint& joint, const Eigen::Map<Mat6X<S>>& J, const ConstVecRef<S>& v) {
  Vec6<S> out = J.col(0) * v[joint.idx_v];
  for (int k = 1; k < joint.nv(); ++k) out += J.col(k) * v[joint.idx_v + k];
  return out;
}

}  // namespace

template <class S>
void place_trees(const Model& model, const SE3<double>& base, const ConstVecRef<S>& q, BodyKinematics<S>& kin) {
  std::array<SE3<S>, 6> placed;  // a path has at most six joints
  for (std::size_t k = 0; k < model.trees.size(); ++k) {
    const Tree& tree = model.trees[k];
    S s, c;
    sin_cos(angle_of<S>(model.joints[tree.root], q), s, c);
    kin.origins[k] = place_path<S>(model, nullptr, tree, base, q, s, c, [&](int i) -> SE3<S>& {
      return placed[std::find(tree.path.begin(), tree.path.end(), i) - tree.path.begin()];
    });
    for (std::size_t j = 0; j < tree.path.size(); ++j) kin.p[tree.path[j]] = placed[j].p;
  }
}

template <class S>
void body_kinematics(const Model& model, const SE3<double>& base, int i, const ConstVecRef<S>& q,
                     const ConstVecRef<S>& v, BodyKinematics<S>& kin, BodyTerms<S> terms) {
  const Joint& joint = model.joints[i];
  const bool root = joint.parent < 0;
  Mat3<S>& R = kin.R[i];
  Vec3<S>& r = *terms.r;
  Eigen::Map<Mat6X<S>> J(terms.S_i, 6, joint.nv());
  if (i == 0 && model.floating_base) {  // the body frame's origin is that of the base, so r = 0
    R = rotation_of_quaternion<S>(q[3], q[4], q[5], q[6]);
    r.setZero();
    J.template block<3, 3>(0, 0) = R;
    J.template block<3, 3>(3, 3) = R;
  } else {
    Mat3<S> base_R;
    if (root) base_R = model.floating_base ? Mat3<S>(Mat3<S>::Identity()) : Mat3<S>(base.R.cast<S>());
    const Mat3<S>& P = root ? base_R : kin.R[joint.parent];
    r.noalias() = P * joint.placement.p.cast<S>();
    if (joint.placement_rotates)
      R.noalias() = P * joint.placement.R.cast<S>();
    else
      R = P;
    move_body<S>(joint, q, R, r, J);
  }
  if (!model.on_path[i]) kin.p[i] = kin.p[joint.parent] + r;
  const Inertia<S>& Y = *terms.Y = joint.inertia.template cast<S>().turned(R);
  const Vec6<S> vJ = joint_motion<S>(joint, J, v);
  if (root) {
    kin.v[i] = vJ;
    terms.c->setZero();
  } else {
    const Vec6<S> vp = motion_at(kin.v[joint.parent], r);
    kin.v[i] = vp + vJ;
    *terms.c = cross_motion(vp, vJ);  // v x S v, since S v x S v = 0
  }
  *terms.h = cross_force(kin.v[i], Y * kin.v[i]);
}

using Real = InstantiatedScalar;
template struct BodyKinematics<Real>;
template void place_trees<Real>(const Model&, const SE3<double>&, const ConstVecRef<Real>&, BodyKinematics<Real>&);
template void body_kinematics<Real>(const Model&, const SE3<double>&, int, const ConstVecRef<Real>&,
                                    const ConstVecRef<Real>&, BodyKinematics<Real>&, BodyTerms<Real>);

}  // namespace manycontact
