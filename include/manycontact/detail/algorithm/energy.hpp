#pragma once
#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact {

/// Computes the kinetic energy of bodies and rotors (armature) [J]. Call it after forward_accelerations. v: nv.
template <class S>
S kinetic_energy(const Model& model, const Kinematics<S>& kin, const ConstVecRef<S>& v);

/// Computes the potential energy of weight [J], zero at the world's origin. Call it after forward_kinematics.
template <class S>
S potential_energy(const Kinematics<S>& kin, const Vec3<double>& gravity);

/// Computes the centre of mass in the world [m], NaN for a robot without mass. Call it after forward_kinematics.
template <class S>
Vec3<S> center_of_mass(const Kinematics<S>& kin);

/// Computes the bodies' total momentum about the world's origin, in world axes: linear [N s], angular [N m s].
template <class S>
Vec6<S> momentum(const Kinematics<S>& kin);

}  // namespace manycontact
