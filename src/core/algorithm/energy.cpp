#include "manycontact/detail/algorithm/energy.hpp"

namespace manycontact {

namespace {

// Returns a robot's mass and first moment of mass about the world's origin, without its links fixed to the world.
template <class S>
std::pair<S, Vec3<S>> moments(const Kinematics<S>& kin) {
  std::pair<S, Vec3<S>> total(S(0), Vec3<S>::Zero());
  for (std::size_t first = 0, end; first < kin.Y.size(); first = end) {
    Inertia<S> Y;
    for (end = first; end < kin.Y.size() && kin.tree_of[end] == kin.tree_of[first]; ++end) Y += kin.Y[end];
    total.first += Y.m;
    total.second += Y.h + Y.m * kin.origin(static_cast<int>(first));
  }
  return total;
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
  return -gravity.cast<S>().dot(moments<S>(kin).second);
}

template <class S>
Vec3<S> center_of_mass(const Kinematics<S>& kin) {
  const auto [mass, moment] = moments<S>(kin);
  return moment / mass;
}

template <class S>
Vec6<S> momentum(const Kinematics<S>& kin) {
  Vec6<S> h = Vec6<S>::Zero();
  for (std::size_t first = 0, end; first < kin.Y.size(); first = end) {
    Vec6<S> of_tree = Vec6<S>::Zero();
    for (end = first; end < kin.Y.size() && kin.tree_of[end] == kin.tree_of[first]; ++end)
      of_tree += kin.Y[end] * kin.v[end];
    of_tree.template tail<3>() += kin.origin(static_cast<int>(first)).cross(Vec3<S>(of_tree.template head<3>()));
    h += of_tree;
  }
  return h;
}

using S = InstantiatedScalar;
template S kinetic_energy<S>(const Model&, const Kinematics<S>&, const ConstVecRef<S>&);
template S potential_energy<S>(const Kinematics<S>&, const Vec3<double>&);
template Vec3<S> center_of_mass<S>(const Kinematics<S>&);
template Vec6<S> momentum<S>(const Kinematics<S>&);

}  // namespace manycontact
