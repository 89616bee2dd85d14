#pragma once
// Forward kinematics for deep trees, joint by joint. Each body has its own **body frame**: world axes, origin at its
// child frame. Bodies far from the base lose digits in the tree frame (detail/algorithm/kinematics.hpp), where inertias
// grow with the squared distance, but not here. A translation r leads from a body to its child:
//
//   motions, to the child:  v_lin += w x r        forces, to the parent:  n += r x f

#include <vector>

#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact {

/// Returns the motion m of a body, given at one point, at a point displaced from it by r.
template <class A, class S>
Vec6<S> motion_at(const Eigen::MatrixBase<A>& m, const Vec3<S>& r) {
  Vec6<S> out = m;
  out.template head<3>() += cross(m.template tail<3>(), r);
  return out;
}
/// Returns the force at the origin that is equivalent to the force f at the point r.
template <class A, class S>
Vec6<S> force_from(const Eigen::MatrixBase<A>& f, const Vec3<S>& r) {
  Vec6<S> out = f;
  out.template tail<3>() += cross(r, f.template head<3>());
  return out;
}

/// Returns the magnitudes of the terms, added up, of a cross product of two vectors whose entries have magnitudes a, b.
template <class S>
Vec3<S> cross_sizes(const Vec3<S>& a, const Vec3<S>& b) {
  return {a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]};
}

/// Placements and motions of a robot's bodies, each in its body frame; allocate once per robot.
template <class S>
struct BodyKinematics {
  explicit BodyKinematics(const Model& model);

  // set by place_trees, from q
  std::vector<WorldPoint<S>> origins;  // one entry per tree: origin of its frame (detail/algorithm/kinematics.hpp)

  // set by body_kinematics, from q and v
  std::vector<Mat3<S>> R;  // njoints: rotation from the child frame to the world
  std::vector<Vec3<S>> p;  // njoints: the child frame's origin in the tree frame; set by place_trees for paths
  std::vector<Vec6<S>> v;  // njoints: spatial velocity in the body frame

  std::vector<int> tree_of;  // njoints: number of the body's tree
};

/// Pointers to the caller's memory for the terms of one joint's equations of motion.
template <class S>
struct BodyTerms {
  Vec3<S>* r;     // origin of the body frame relative to the parent's, or to the base
  S* S_i;         // 6 x nv of the joint, by columns: motion subspace; the caller sets it to zero before the first call
  Inertia<S>* Y;  // the body's inertia
  Vec6<S>* c;     // bias acceleration v x S v of the joint
  Vec6<S>* h;     // bias force v x* Y v of the body
};

/// Computes the placements of the trees at a configuration q (nq). base: world placement of a fixed base.
template <class S>
void place_trees(const Model& model, const SE3<double>& base, const ConstVecRef<S>& q, BodyKinematics<S>& kin);

/// Computes joint i's entries of `kin` and `terms`, after those of its parent and place_trees. q: nq, v: nv.
template <class S>
void body_kinematics(const Model& model, const SE3<double>& base, int i, const ConstVecRef<S>& q,
                     const ConstVecRef<S>& v, BodyKinematics<S>& kin, BodyTerms<S> terms);

}  // namespace manycontact
