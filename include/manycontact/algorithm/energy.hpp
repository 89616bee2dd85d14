#pragma once
#include "manycontact/algorithm/kinematics.hpp"

namespace manycontact {

/// Kinetic energy of the bodies and of the rotors (armature), J. After forward_accelerations. v: nv.
template <class S>
S kinetic_energy(const Model& model, const Kinematics<S>& kin, const ConstVecRef<S>& v);

/// Potential energy in the gravity field, zero at the world's origin, J. After forward_kinematics.
template <class S>
S potential_energy(const Kinematics<S>& kin, const Vec3<double>& gravity);

/// Centre of mass in the world, m; NaN for a robot without mass. After forward_kinematics.
template <class S>
Vec3<S> center_of_mass(const Kinematics<S>& kin);

/// Momentum of the bodies about the world's origin, in world axes: linear [N s], angular [N m s].
template <class S>
Vec6<S> momentum(const Kinematics<S>& kin);

}  // namespace manycontact
