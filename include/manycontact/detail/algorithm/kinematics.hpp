#pragma once
// Forward kinematics of one robot in its **tree frame**: world axes, with the origin on one of its bodies, the anchor.
// The anchor is the floating base. With a fixed base, the anchor is the body behind the joints that place the robot in
// the world (model/model.hpp, Tree).
//
// The tree frame is an inertial frame at the current instant, so that motions and forces of all bodies add without
// transforms. Since bodies are placed relative to the anchor, no digits are lost far from the world's origin. If
// several trees are attached to one fixed base, each tree has a frame of its own.

#include <vector>

#include "manycontact/model/model.hpp"

namespace manycontact {

/// A point of the world with extended precision: p + rest, where `rest` is the rounding error of p.
template <class S>
struct WorldPoint {
  Vec3<S> p = Vec3<S>::Zero(), rest = Vec3<S>::Zero();

  /// Returns this point relative to `b`. If the points are close to each other, its error is a rounding error of its
  /// own size.
  Vec3<S> seen_from(const WorldPoint& b) const { return Vec3<S>(p - b.p) + Vec3<S>(rest - b.rest); }
};

template <class S>
struct ModelNumbers;  // private to the module algorithm

/// Placements and motions of a robot's bodies, all in the tree frame. Allocated once per robot.
template <class S>
struct Kinematics {
  explicit Kinematics(const Model& model);  // allocates the workspace of this robot

  // Computed by forward_kinematics, from q.
  std::vector<WorldPoint<S>> origins;  // one entry per tree: the origin of its frame in the world [m]
  std::vector<SE3<S>> oMi;             // njoints: placement of each child frame
  Mat6X<S> J;                          // 6 x nv: motion subspace S_i of each velocity coordinate
  std::vector<Inertia<S>> Y;           // njoints: inertia of each body

  // Computed by forward_accelerations, from v and qdd.
  std::vector<Vec6<S>> v;  // njoints: spatial velocity
  std::vector<Vec6<S>> a;  // njoints: spatial acceleration minus gravity
  Vec6<S> a_base;          // acceleration of the base: minus gravity

  std::vector<int> tree_of;  // njoints: the number of the body's tree

  /// Parameters of a SIMD batch's robots if their models differ (Model::structure); nullptr: they share the model.
  const ModelNumbers<S>* own = nullptr;

  /// Returns the origin, in the world, of the tree frame of a joint's body.
  const Vec3<S>& origin(int joint) const { return origins[tree_of[joint]].p; }
};

/// Computes placements, motion subspaces and inertias. q: nq. base: the placement of the fixed base in the world, in
/// double, or in S for a SIMD batch. A floating base ignores it, as q has its placement.
template <class S, class B = double>
void forward_kinematics(const Model& model, const SE3<B>& base, const ConstVecRef<S>& q, Kinematics<S>& kin);

/// Computes velocities and accelerations: v_i = v_p + S_i v, a_i = a_p + S_i qdd + v_i x S_i v, p the parent of i,
/// a_base = -g. Sizes: v nv; qdd nv, or nullptr for zero: kin.a is then the bias acceleration.
template <class S>
void forward_accelerations(const Model& model, const ConstVecRef<S>& v, const S* qdd, const Vec3<double>& gravity,
                           Kinematics<S>& kin);

}  // namespace manycontact
