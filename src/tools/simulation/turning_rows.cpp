#include "manycontact/contact/turning_rows.hpp"

#include "internal.hpp"
#include "momentum_steps.hpp"

namespace manycontact::internal {

bool rows_may_turn(const Scene& scene, const SimulationData& d) {
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    if (d.dynamics.active[c] && leaves_directions(contact)) return true;
  }
  return false;
}

bool follow_turning_rows(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, SimulationData& d) {
  kinematics_at(scene, q, v, d.at_rest.kin);
  bool any = false;
  for (std::size_t k = 0; k < scene.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[k];
    if (d.dynamics.f_offset[k] < 0 || !leaves_directions(contact)) continue;
    ContactData<double>& rows = d.at_rest.contacts[k];
    contact_rows<double>(scene, contact, {}, d.at_rest.kin[static_cast<std::size_t>(contact.A.robot)],
                         contact.B.robot < 0 ? nullptr : &d.at_rest.kin[static_cast<std::size_t>(contact.B.robot)],
                         rows);
    const Eigen::Vector2d turning = turning_of_rows(contact, rows);
    if (turning.isZero(0)) continue;
    any = true;
    auto wanted = d.wanted.segment(d.dynamics.f_offset[k], contact.rows());
    wanted += turning.head(contact.rows());
    if (contact.alpha != 0)
      wanted.noalias() += rows.W * contact_error<double>(contact, rows.G, contact.alpha);
  }
  return any;
}

}  // namespace manycontact::internal
