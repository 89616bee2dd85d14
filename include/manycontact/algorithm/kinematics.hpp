#pragma once
// Forward kinematics of one robot, in its **tree frame**: world axes, origin on one of its bodies, the anchor: the
// floating base, or of a fixed base the body behind the joints that say where the robot stands (model/model.hpp, Tree).
// The tree frame is an inertial frame (at the instant), so motions and forces of all bodies add without transforms; and
// far from the world's origin, or from the robot's own, no digits are lost: bodies are placed from the anchor on, up
// the tree too, and where the anchor is in the world is not among their numbers. Where several trees hang on one fixed
// base, each has a frame of its own.

#include <vector>

#include "manycontact/model/model.hpp"

namespace manycontact {

/// A point of the world: p + rest, where `rest` is what p, rounded, has no room for.
template <class S>
struct WorldPoint {
  Vec3<S> p = Vec3<S>::Zero(), rest = Vec3<S>::Zero();

  /// From `b` to this point, exact but for the last rounding where they are near each other.
  Vec3<S> seen_from(const WorldPoint& b) const { return Vec3<S>(p - b.p) + Vec3<S>(rest - b.rest); }
};

template <class S>
struct ModelNumbers;  // manycontact/algorithm/model_numbers.hpp

/// Where a robot's bodies are and how they move. Everything is in the tree frame. Allocated once per robot.
template <class S>
struct Kinematics {
  explicit Kinematics(const Model& model);  // room for this robot

  // by forward_kinematics, from q
  std::vector<WorldPoint<S>> origins;  // per tree: the origin of its frame [m]
  std::vector<SE3<S>> oMi;             // njoints: placement of each child frame
  Mat6X<S> J;                          // 6 x nv: motion subspace S_i of each velocity coordinate
  std::vector<Inertia<S>> Y;           // njoints: inertia of each body

  // by forward_accelerations, from v and qdd
  std::vector<Vec6<S>> v;  // njoints: spatial velocity
  std::vector<Vec6<S>> a;  // njoints: spatial acceleration minus gravity
  Vec6<S> a_base;          // what the base accelerates with: -g

  std::vector<int> tree_of;  // njoints: which of the model's trees a body is of

  /// Where robots that stand side by side are of models of their own (Model::structure); nullptr: all are of the model.
  const ModelNumbers<S>* own = nullptr;

  /// Origin of the frame that a joint's body is in, in the world.
  const Vec3<S>& origin(int joint) const { return origins[tree_of[joint]].p; }
};

/// Placements, motion subspaces and inertias. q: nq. base: the fixed base's placement in the world (a floating base
/// has it in q), in doubles or, where robots stand side by side, in S.
template <class S, class B = double>
void forward_kinematics(const Model& model, const SE3<B>& base, const ConstVecRef<S>& q, Kinematics<S>& kin);

/// Velocities and accelerations: v_i = v_p + S_i v, a_i = a_p + S_i qdd + v_i x S_i v, a_base = -g.
/// v: nv; qdd: nv, or nullptr for zero (then kin.a is the bias acceleration).
template <class S>
void forward_accelerations(const Model& model, const ConstVecRef<S>& v, const S* qdd, const Vec3<double>& gravity,
                           Kinematics<S>& kin);

}  // namespace manycontact
