// Decides, for every IslandSystem and for pairs, whether contacts are inconsistent. They are if the residual of
// rank/contradiction.hpp exceeds rounding errors of the accelerations that contacts cancel. These are gravity or,
// without gravity, |J| |tau - h| / max M_ii.

#include <algorithm>
#include <cmath>

#include "internal.hpp"
#include "manycontact/rank/row_units.hpp"

namespace manycontact::internal {

namespace {

// Returns the largest acceleration that torques cause along a constraint row, computed with each robot's largest
// inertia. With the inertia of light links, this acceleration would be so large that it hides inconsistencies.
double accelerations_of_torques(const Scene& scene, const SceneData& data, const IslandWork& d) {
  const Workspace& w = *data.workspace;
  const auto largest_inertia = [&](int r) {
    const Model& model = *scene.robots[r].model;
    double largest = 0;
    for (int i = 0; i < model.nv; ++i) largest = std::max(largest, w.robots[r].M[model.M_begin[i]]);
    return largest;
  };
  double largest = 0;
  for (int c : d.island.contacts) {
    const Contact& contact = scene.contacts[c];
    const ContactSupport& support = w.supports[c];
    for (int row = 0; row < contact.rows(); ++row) {
      const auto J = w.contacts[c].J.row(row);
      Eigen::Index k = 0;
      double sum = 0;
      const auto add = [&](int r, std::span<const int> coordinates) {
        double torques = 0;
        for (int i : coordinates) torques += std::abs(J[k++] * (data.tau[scene.robots[r].idx_v + i] - w.robots[r].h[i]));
        if (torques > 0) sum += torques / largest_inertia(r);
      };
      add(contact.A.robot, support.a);
      add(contact.B.robot, support.b);
      largest = std::max(largest, sum * row_unit(scene, contact, row));
    }
  }
  return largest;
}

}  // namespace

bool contradicts(const Scene& scene, const SceneData& data, rank::Contradiction<double> of, IslandWork& d) {
  if (!of.contradicts()) return false;
  if (const double gravity = scene.gravity.norm(); gravity > 0) return !(of.left <= tolerance::kLoadRounding * gravity);
  if (!joint_space_fits(d)) return true;
  evaluate_at_state(scene, data, d);
  return !(of.left <= tolerance::kTorqueRounding * accelerations_of_torques(scene, data, d));
}

}  // namespace manycontact::internal
