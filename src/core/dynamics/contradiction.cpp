// The judge of contradictions, for all systems and for pairs of bodies: rank/contradiction.hpp, and no rounding error
// of the loads' accelerations, gravity and |J| |tau - h| / diag M, which contacts may cancel in a.

#include <algorithm>
#include <cmath>

#include "internal.hpp"
#include "manycontact/rank/row_units.hpp"

namespace manycontact::internal {

namespace {

// The largest acceleration of a row by each coordinate's own torque alone: |J| |tau - h| / diag M.
double accelerations_of_torques(const Scene& scene, const SceneData& data, const IslandWork& d) {
  const Workspace& w = *data.workspace;
  const auto of_coordinate = [&](int r, int i) {
    const Robot& robot = scene.robots[r];
    const double inertia = w.robots[r].M[robot.model->M_begin[i]];
    return inertia > 0 ? std::abs(data.tau[robot.idx_v + i] - w.robots[r].h[i]) / inertia : 0;
  };
  double largest = 0;
  for (int c : d.island.contacts) {
    const Contact& contact = scene.contacts[c];
    const ContactSupport& support = w.supports[c];
    for (int row = 0; row < contact.rows(); ++row) {
      const auto J = w.contacts[c].J.row(row);
      Eigen::Index k = 0;
      double sum = 0;
      for (int i : support.a) sum += std::abs(J[k++]) * of_coordinate(contact.A.robot, i);
      for (int i : support.b) sum += std::abs(J[k++]) * of_coordinate(contact.B.robot, i);
      largest = std::max(largest, sum * row_unit(scene, contact, row));
    }
  }
  return largest;
}

}  // namespace

bool contradicts(const Scene& scene, const SceneData& data, rank::Contradiction<double> of, IslandWork& d) {
  if (!of.contradicts()) return false;
  double rounding = tolerance::kLoadRounding * scene.gravity.norm();
  const auto exceeds_rounding = [&] { return !(of.left <= rounding); };
  if (!exceeds_rounding() || !joint_space_fits(d)) return exceeds_rounding();
  evaluate_at_state(scene, data, d);
  rounding += tolerance::kTorqueRounding * accelerations_of_torques(scene, data, d);
  return exceeds_rounding();
}

}  // namespace manycontact::internal
