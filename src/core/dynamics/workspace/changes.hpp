#pragma once
// Copies scene properties that may change while data are in use (data.hpp) into internal scenes.

#include "manycontact/model/scene.hpp"

namespace manycontact::internal {

inline void take_changes(const Contact& from, Contact& to) {
  to.reference_frame = from.reference_frame;
  to.alpha = from.alpha, to.beta = from.beta;
  to.B.placement = from.B.placement;
}

/// Copies all but contacts' properties. `to` contains robots, wrenches and springs of `from` once or several times.
inline void take_changes(const Scene& from, Scene& to) {
  to.gravity = from.gravity;
  to.damping = from.damping;
  to.tolerance = from.tolerance;
  to.moment_length = from.moment_length;
  for (std::size_t r = 0; r < to.robots.size(); ++r) to.robots[r].base = from.robots[r % from.robots.size()].base;
  const auto each = [](auto& list, const auto& given, auto&& take) {
    for (std::size_t k = 0; k < list.size(); ++k) take(list[k], given[k % given.size()]);
  };
  if (!has_applied_forces(from)) {
    to.wrenches.clear(), to.springs.clear(), to.joint_springs.clear();
    return;
  }
  each(to.wrenches, from.wrenches, [](ExternalWrench& push, const ExternalWrench& given) {
    push.at.placement = given.at.placement;
    push.reference_frame = given.reference_frame;
  });
  each(to.springs, from.springs, [](Spring& spring, const Spring& given) {
    spring.A.placement = given.A.placement;
    spring.B.placement = given.B.placement;
    spring.stiffness = given.stiffness, spring.length = given.length, spring.damping = given.damping;
  });
  each(to.joint_springs, from.joint_springs, [](JointSpring& spring, const JointSpring& given) {
    spring.stiffness = given.stiffness, spring.rest = given.rest;
  });
}

inline void take_all_changes(const Scene& from, Scene& to) {  // copies those of contacts, too
  take_changes(from, to);
  for (std::size_t c = 0; c < to.contacts.size(); ++c)
    take_changes(from.contacts[c % from.contacts.size()], to.contacts[c]);
}

}  // namespace manycontact::internal
