#include <cmath>
#include <memory>

#include "manycontact/analysis/findings.hpp"
#include "manycontact/contact/rows.hpp"
#include "manycontact/spatial/explog.hpp"

namespace manycontact {

namespace {

// Kinematics of one robot at rest, its memory used again for the next of the same model.
class AtRest {
 public:
  AtRest(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q) : scene_(scene), q_(q) {}

  const Kinematics<double>& of(int r) {
    if (r == robot_) return *kin_;
    const Robot& robot = scene_.robots[r];
    if (robot_ < 0 || scene_.robots[robot_].model != robot.model) {
      kin_ = std::make_unique<Kinematics<double>>(*robot.model);
      rest_.setZero(robot.model->nv);
    }
    robot_ = r;
    forward_kinematics<double>(*robot.model, robot.base, q_.segment(robot.idx_q, robot.model->nq), *kin_);
    forward_accelerations<double>(*robot.model, rest_, nullptr, scene_.gravity, *kin_);
    return *kin_;
  }

 private:
  const Scene& scene_;
  const Eigen::Ref<const Eigen::VectorXd>& q_;
  int robot_ = -1;
  std::unique_ptr<Kinematics<double>> kin_;
  Eigen::VectorXd rest_;
};

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
  AtRest on_A(scene, q), on_B(scene, q);
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
