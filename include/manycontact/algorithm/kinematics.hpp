#pragma once
// Forward kinematics of one robot, in its **tree frame**: world axes, origin at the robot's base. The tree frame is an
// inertial frame (at the instant), so motions and forces of all bodies add without transforms; and far from the world's
// origin no digits are lost.

#include <vector>

#include "manycontact/model/model.hpp"

namespace manycontact {

/// Where a robot's bodies are and how they move. Everything is in the tree frame. Allocated once per robot.
template <class S>
struct Kinematics {
  explicit Kinematics(const Model& model);  // room for this robot

  // by forward_kinematics, from q
  Vec3<S> origin;             // the tree frame's origin in the world [m]
  std::vector<SE3<S>> oMi;    // njoints: placement of each child frame
  Mat6X<S> J;                 // 6 x nv: motion subspace S_i of each velocity coordinate
  std::vector<Inertia<S>> Y;  // njoints: inertia of each body

  // by forward_accelerations, from v and qdd
  std::vector<Vec6<S>> v;  // njoints: spatial velocity
  std::vector<Vec6<S>> a;  // njoints: spatial acceleration minus gravity
  Vec6<S> a_base;          // what the base accelerates with: -g
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
