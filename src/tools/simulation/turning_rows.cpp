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

namespace {

// Calls use(contact, rows, turning, wanted) for active contacts whose rows rotate at the state of at_rest.kin. turning:
// each row's acceleration minus the rate of its J v; wanted: the contact's part of d.wanted.
template <class Use>
bool each_turning(const Scene& scene, SimulationData& d, Use&& use) {
  bool any = false;
  for (std::size_t k = 0; k < scene.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[k];
    if (d.dynamics.f_offset[k] < 0 || !leaves_directions(contact)) continue;
    ContactData<double>& rows = d.at_rest.contacts[k];
    contact_rows<double>(scene, contact, {}, d.at_rest.kin[contact.A.robot],
                         contact.B.robot < 0 ? nullptr : &d.at_rest.kin[contact.B.robot], rows);
    const Eigen::Vector2d turning = turning_of_rows(contact, rows);
    if (turning.isZero(0)) continue;
    any = true;
    auto wanted = d.wanted.segment(d.dynamics.f_offset[k], contact.rows());
    use(contact, rows, turning.head(contact.rows()), wanted);
  }
  return any;
}

}  // namespace

bool follow_turning_rows(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, SimulationData& d) {
  kinematics_at(scene, q, v, d.at_rest.kin);
  return each_turning(scene, d, [](const Contact& contact, const auto& rows, const auto& turning, auto& wanted) {
    wanted += turning;
    wanted.noalias() += rows.W * contact_error<double>(contact, rows.G, contact.alpha);
  });
}

void leave_out_alpha_of_turning_rows(const Scene& scene, SimulationData& d) {
  kinematics_at(scene, d.q, d.v, d.at_rest.kin);
  each_turning(scene, d, [&](const Contact& contact, const auto& rows, const auto&, auto& wanted) {
    wanted.noalias() += rows.W * contact_error<double>(contact, rows.G, d.h * contact.alpha);
  });
}

}  // namespace manycontact::internal
