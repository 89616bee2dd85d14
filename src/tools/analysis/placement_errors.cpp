#include <algorithm>
#include <cmath>

#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/text.hpp"
#include "manycontact/contact/motion_of.hpp"
#include "manycontact/contact/turning_rows.hpp"
#include "manycontact/model/expect_state.hpp"
#include "manycontact/spatial/explog.hpp"

namespace manycontact {

namespace {

// Returns the angle between the axes of A and B (6D) or between the hinge axes (5D), and 0 for other contacts.
double angle_between(const Contact& contact, const Mat3<double>& G) {
  if (contact.type == ContactType::k6D) return log3<double>(G).norm();
  if (contact.type != ContactType::k5D) return 0;
  const Vec3<double> m = G.transpose() * contact.axis;
  return std::atan2(m.cross(contact.axis).norm(), m.dot(contact.axis));
}

}  // namespace

std::vector<PlacementError> placement_errors(const Scene& scene, const ConstVectorRef& q,
                                             const std::vector<char>& active) {
  expect_configuration("placement_errors", "q", q, scene);
  std::vector<PlacementError> out;
  internal::each_contact_at(scene, active, q, nullptr, [&](int c, const ContactData<double>& d) {
    const Contact& contact = scene.contacts[c];
    const int held = std::min(3, contact.rows());
    const double position = (d.W * contact_error<double>(contact, d.G)).head(held).norm();
    const double angle = angle_between(contact, d.G.R);
    if (position >= kPlacementError || angle >= kPlacementError) out.push_back({c, position, angle});
  });
  return out;
}

std::vector<VelocityError> velocity_errors(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                           const std::vector<char>& active) {
  expect_configuration("velocity_errors", "q", q, scene);
  expect_numbers("velocity_errors", "v", v, scene.nv);
  std::vector<VelocityError> out;
  internal::each_contact_at(scene, active, q, v.data(), [&](int c, const ContactData<double>& d) {
    const Eigen::VectorXd Jv = d.W * d.nu;
    const Eigen::Index held = std::min<Eigen::Index>(3, Jv.size());
    const VelocityError e{c, Jv.head(held).norm(), Jv.tail(Jv.size() - held).norm()};
    if (e.linear >= kVelocityError || e.angular >= kVelocityError) out.push_back(e);
  });
  return out;
}

std::vector<TurningRows> turning_rows(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                      const std::vector<char>& active) {
  expect_configuration("turning_rows", "q", q, scene);
  expect_numbers("turning_rows", "v", v, scene.nv);
  std::vector<TurningRows> out;
  std::vector<char> looked = active;
  for (std::size_t c = 0; c < looked.size(); ++c)
    looked[c] = looked[c] && internal::leaves_directions(scene.contacts[c]);
  if (std::ranges::find(looked, 1) == looked.end()) return out;
  internal::each_contact_at(scene, looked, q, v.data(), [&](int c, const ContactData<double>& d) {
    const double rate = internal::turning_of_rows(scene.contacts[c], d).norm();
    if (rate >= kTurningRows) out.push_back({c, rate});
  });
  return out;
}

std::string in_words(const PlacementError& e) {
  return text::two_sizes(e.position, "m", e.angle, "rad", kPlacementError);
}
std::string in_words(const VelocityError& e) {
  return text::two_sizes(e.linear, "m/s", e.angular, "rad/s", kVelocityError);
}

std::string name_of(const Scene& scene, const Unbalanced& x) {
  const Robot& robot = scene.robots[x.robot];
  return robot.name + "/" + dof_name(*robot.model, x.dof);
}

std::string in_words(const Unbalanced& x) {
  return "no torques keep this coordinate at rest in this configuration: a load of " + text::number(x.force) +
         (x.angular ? " N m" : " N") + " remains";
}

}  // namespace manycontact
