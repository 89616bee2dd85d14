#include "manycontact/detail/simulation/invariants.hpp"

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/detail/algorithm/energy.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/spatial/explog.hpp"
#include "momentum_steps.hpp"

namespace manycontact {

namespace {

// Sets `largest` to max(largest, |x|), or to NaN if largest or x is NaN.
void raise(double& largest, double x) { largest = sparse::larger_or_nan(largest, std::abs(x)); }

// Returns the placement error W e of a contact: the error e of its frames, expressed in its constraint rows W.
Vec6<double> placement_error(const Contact& contact, const ContactData<double>& d) {
  Vec6<double> e = Vec6<double>::Zero(), rows = e;
  if (contact.type == ContactType::k6D)
    e = log6<double>(d.G);
  else
    e.head<3>() = d.G.R.transpose() * d.G.p;
  if (contact.type == ContactType::k5D)  // angular error: angle between the hinges' axes
    e.tail<3>() = Vec3<double>(d.G.R.transpose() * contact.axis).cross(contact.axis);
  for (Eigen::Index i = 0; i < d.W.rows(); ++i) rows[i] = d.W.row(i).dot(e);
  return rows;
}

}  // namespace

InvariantsData::InvariantsData(const Scene& scene) {
  for (const Robot& robot : scene.robots) kin.emplace_back(*robot.model);
  for (const Contact& contact : scene.contacts) {
    supports.push_back(contact_support(scene, contact));
    contacts.emplace_back(contact, supports.back());
  }
}

Invariants invariants(const Scene& scene, const std::vector<char>& active, const Eigen::Ref<const Eigen::VectorXd>& q,
                      const Eigen::Ref<const Eigen::VectorXd>& v, InvariantsData& data) {
  Invariants out;
  internal::kinematics_at(scene, q, v, data.kin);
  for (std::size_t k = 0; k < scene.robots.size(); ++k) {
    const Robot& robot = scene.robots[k];
    out.kinetic += kinetic_energy<double>(*robot.model, data.kin[k], v.segment(robot.idx_v, robot.model->nv));
    out.potential += potential_energy<double>(data.kin[k], scene.gravity);
    out.momentum += momentum<double>(data.kin[k]);
  }
  out.potential += energy_of_springs(scene, q, data.kin);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (!active[c]) continue;
    const Contact& contact = scene.contacts[c];
    ContactData<double>& d = data.contacts[c];
    contact_rows<double>(scene, contact, data.supports[c], data.kin[contact.A.robot],
                         contact.B.robot < 0 ? nullptr : &data.kin[contact.B.robot], d);
    const Vec6<double> e = placement_error(contact, d);
    for (Eigen::Index i = 0; i < d.W.rows(); ++i) {
      raise(out.violation_position, e[i]);
      raise(out.violation_velocity, d.W.row(i).dot(d.nu));  // J v = W nu, nu: relative velocity of the contact's frames
    }
  }
  return out;
}

}  // namespace manycontact
