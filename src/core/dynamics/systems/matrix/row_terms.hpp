#pragma once
// Magnitudes of the terms from which rows of K are computed, for contacts (rank/row_size.hpp) and robots.

#include "../../workspace/workspace.hpp"
#include "manycontact/rank/row_size.hpp"

namespace manycontact::internal {

/// Calls use(model, kinematics, model, kinematics) with those of the robots at a contact's ends A and B. A fixed end
/// has those of the other end's robot.
template <class Use>
RowTerms<double> with_robots_of(const Scene& scene, const Workspace& work, const Contact& contact, Use&& use) {
  const int a = moves(contact.A) ? contact.A.robot : contact.B.robot, b = moves(contact.B) ? contact.B.robot : a;
  return use(*scene.robots[a].model, work.robots[a].kin, *scene.robots[b].model, work.robots[b].kin);
}

inline RowTerms<double> row_terms(const Scene& scene, const Workspace& work, int c) {
  const Contact& contact = scene.contacts[c];
  return with_robots_of(scene, work, contact,
                        [&](const auto&... robots) { return row_terms<double>(contact, work.contacts[c], robots...); });
}

inline RowTerms<double> bias_acceleration_terms(const Scene& scene, const Workspace& work, int c) {
  const Contact& contact = scene.contacts[c];
  return with_robots_of(scene, work, contact, [&](const auto&... robots) {
    return bias_acceleration_terms<double>(contact, work.contacts[c], robots..., contact.B.placement.p);
  });
}

template <class Motions>
std::pair<double, double> largest_of_motions(const Motions& J) {  // largest linear, largest angular entry of J (6 x n)
  if (J.cols() == 0) return {};
  return {J.template topRows<3>().cwiseAbs().maxCoeff(), J.template bottomRows<3>().cwiseAbs().maxCoeff()};
}

/// Returns magnitudes of the terms of a contact's rows of J: translations, and rotations times moment arms.
inline RowTerms<double> motion_terms(const Contact& contact, const ContactData<double>& data) {
  const auto [moved, turning] = largest_of_motions(data.Jl);
  double lever = largest_entry<double>(data.aMA.p) + largest_entry<double>(data.on_A) + data.joint_lever;
  if (moves(contact.B)) lever += largest_entry<double>(data.bMA.p);
  return {std::max(moved, turning * lever), turning, data.pair ? &*data.pair : nullptr};
}

/// Computes, per velocity coordinate, magnitudes of the terms of M a + h and of the largest entry in M's row.
void torque_terms(const Model& model, const RobotData& robot, const double* a, double* terms,
                  double* largest_of_M = nullptr);

}  // namespace manycontact::internal
