#pragma once
// dynamics/contact_drift.hpp of a contact at the state at hand.

#include "../../contact_drift.hpp"
#include "../../workspace.hpp"

namespace manycontact::internal {

/// use(model and kinematics of A's robot, those of B's); of an end that does not move, the other's.
template <class Use>
double with_robots_of(const Scene& scene, const Workspace& work, const Contact& contact, Use&& use) {
  const int a = moves(contact.A) ? contact.A.robot : contact.B.robot, b = moves(contact.B) ? contact.B.robot : a;
  return use(*scene.robots[a].model, work.robots[a].kin, *scene.robots[b].model, work.robots[b].kin);
}

inline double row_terms(const Scene& scene, const Workspace& work, int c) {
  const Contact& contact = scene.contacts[c];
  return with_robots_of(scene, work, contact,
                        [&](const auto&... robots) { return row_terms<double>(contact, work.contacts[c], robots...); });
}

inline double contact_drift(const Scene& scene, const Workspace& work, int c) {
  const Contact& contact = scene.contacts[c];
  return with_robots_of(scene, work, contact, [&](const auto&... robots) {
    return contact_drift<double>(contact, work.contacts[c], robots..., contact.B.placement.p);
  });
}

}  // namespace manycontact::internal
