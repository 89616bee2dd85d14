#include "manycontact/algorithm/energy.hpp"

namespace manycontact {

namespace {

// The whole robot's inertia about the tree frame's origin; bodies on an immovable base are not part of the model.
template <class S>
Inertia<S> total(const Kinematics<S>& kin) {
  Inertia<S> Y;
  for (const Inertia<S>& body : kin.Y) Y += body;
  return Y;
}

}  // namespace

template <class S>
S kinetic_energy(const Model& model, const Kinematics<S>& kin, const ConstVecRef<S>& v) {
  S twice(0);
  for (std::size_t i = 0; i < kin.Y.size(); ++i) twice += kin.v[i].dot(kin.Y[i] * kin.v[i]);
  for (int i = 0; i < model.nv; ++i) twice += S(model.armature[i]) * v[i] * v[i];
  return twice / S(2);
}

template <class S>
S potential_energy(const Kinematics<S>& kin, const Vec3<double>& gravity) {
  const Inertia<S> Y = total<S>(kin);
  return -gravity.cast<S>().dot(Y.h + Y.m * kin.origin);
}

template <class S>
Vec3<S> center_of_mass(const Kinematics<S>& kin) {
  const Inertia<S> Y = total<S>(kin);
  return kin.origin + Y.h / Y.m;
}

template <class S>
Vec6<S> momentum(const Kinematics<S>& kin) {
  Vec6<S> h = Vec6<S>::Zero();
  for (std::size_t i = 0; i < kin.Y.size(); ++i) h += kin.Y[i] * kin.v[i];
  h.template tail<3>() += kin.origin.cross(Vec3<S>(h.template head<3>()));
  return h;
}

using S = InstantiatedScalar;
template S kinetic_energy<S>(const Model&, const Kinematics<S>&, const ConstVecRef<S>&);
template S potential_energy<S>(const Kinematics<S>&, const Vec3<double>&);
template Vec3<S> center_of_mass<S>(const Kinematics<S>&);
template Vec6<S> momentum<S>(const Kinematics<S>&);

}  // namespace manycontact
