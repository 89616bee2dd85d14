#include <cmath>

#include "at_rest.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/contact/rows.hpp"
#include "manycontact/spatial/explog.hpp"

namespace manycontact {

namespace {

// Between A's axes and B's, or between their hinges'.
double angle_between(const Contact& contact, const Mat3<double>& G) {
  if (contact.type == ContactType::k6D) return log3<double>(G).norm();
  if (contact.type != ContactType::k5D) return 0;
  const Vec3<double> m = G.transpose() * contact.axis;
  return std::atan2(m.cross(contact.axis).norm(), m.dot(contact.axis));
}

}  // namespace

std::vector<PlacementError> placement_errors(const Scene& scene, const std::vector<char>& active,
                                             const Eigen::Ref<const Eigen::VectorXd>& q) {
  std::vector<PlacementError> out;
  internal::AtRest on_A(scene, q), on_B(scene, q);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (!active[c]) continue;
    const Contact& contact = scene.contacts[c];
    const ContactSupport none;  // W and G alone are looked at
    ContactData<double> d(contact, none);
    const Kinematics<double>& kinA = on_A.of(contact.A.robot);
    const Kinematics<double>* kinB = contact.B.robot < 0                  ? nullptr
                                     : contact.B.robot == contact.A.robot ? &kinA
                                                                          : &on_B.of(contact.B.robot);
    contact_rows<double>(scene, contact, none, kinA, kinB, d);
    const int held = std::min(3, contact.rows());
    const double position = (d.W.topLeftCorner(held, 3) * (d.G.R.transpose() * d.G.p)).norm();
    const double angle = angle_between(contact, d.G.R);
    if (position >= kPlacementError || angle >= kPlacementError) out.push_back({static_cast<int>(c), position, angle});
  }
  return out;
}

}  // namespace manycontact
