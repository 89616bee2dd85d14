#pragma once
// The parameters of robots that algorithms read: the model's, or in a SIMD batch possibly a set for each robot.

#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact {

template <class S>
struct ModelNumbers {
  explicit ModelNumbers(const Model& model)
      : placement(model.joints.size()), inertia(model.joints.size()), armature(model.nv) {}

  std::vector<SE3<S>> placement;    // njoints: Joint::placement
  std::vector<Inertia<S>> inertia;  // njoints: Joint::inertia
  VecX<S> armature;                 // nv
};

/// The placement of joint i. Its rotation and translation are converted to S only when requested.
template <class S>
struct PlacementOf {
  const SE3<double>& of_model;
  const SE3<S>* own;  // nullptr: of_model is used

  PlacementOf(const Model& model, const ModelNumbers<S>* numbers, int i)
      : of_model(model.joints[i].placement), own(numbers ? &numbers->placement[i] : nullptr) {}
  [[gnu::always_inline]] Vec3<S> p() const {
    if constexpr (requires { S::width; })
      if (own) return own->p;
    return of_model.p.template cast<S>();
  }
  [[gnu::always_inline]] Mat3<S> R() const {
    if constexpr (requires { S::width; })
      if (own) return own->R;
    return of_model.R.template cast<S>();
  }
};

template <class S>
[[gnu::always_inline]] inline Inertia<S> joint_space_inertia(const Model& model, const ModelNumbers<S>* own, int i) {
  if constexpr (requires { S::width; })
    if (own) return own->inertia[i];
  return model.joints[i].inertia.template cast<S>();
}

template <class S>
[[gnu::always_inline]] inline S armature_of(const Model& model, const ModelNumbers<S>* own, int i) {
  if constexpr (requires { S::width; })
    if (own) return own->armature[i];
  return S(model.armature[i]);
}

}  // namespace manycontact
