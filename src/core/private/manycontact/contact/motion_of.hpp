#pragma once
#include <memory>

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/detail/contact/rows.hpp"

namespace manycontact::internal {

/// Computes the kinematics of one robot at a time, at q (scene.nq) and v (scene.nv; nullptr: at rest). Memory is reused
/// for robots with the same model.
class MotionOf {
 public:
  MotionOf(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, const double* v = nullptr)
      : scene_(scene), q_(q), v_(v) {}

  const Kinematics<double>& of(int r) {
    if (r == robot_) return *kin_;
    const Robot& robot = scene_.robots[r];
    const int nv = robot.model->nv;
    if (robot_ < 0 || scene_.robots[robot_].model != robot.model) {
      kin_ = std::make_unique<Kinematics<double>>(*robot.model);
      own_v_.setZero(nv);
    }
    robot_ = r;
    if (v_) own_v_ = Eigen::Map<const Eigen::VectorXd>(v_ + robot.idx_v, nv);
    forward_kinematics<double>(*robot.model, robot.base, q_.segment(robot.idx_q, robot.model->nq), *kin_);
    forward_accelerations<double>(*robot.model, own_v_, nullptr, scene_.gravity, *kin_);
    return *kin_;
  }

 private:
  const Scene& scene_;
  const Eigen::Ref<const Eigen::VectorXd>& q_;
  const double* v_;
  int robot_ = -1;
  std::unique_ptr<Kinematics<double>> kin_;
  Eigen::VectorXd own_v_;
};

/// Calls look(c, support, rows) for each contact c flagged `active`, with the contact's rows at q, v. contact_support
/// must return the coordinates of the columns of J (`support`) for a contact.
template <class Support, class Look>
void each_contact_at(const Scene& scene, const std::vector<char>& active, const Eigen::Ref<const Eigen::VectorXd>& q,
                     const double* v, Support&& contact_support, Look&& look) {
  MotionOf on_A(scene, q, v), on_B(scene, q, v);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (!active[c]) continue;
    const Contact& contact = scene.contacts[c];
    const ContactSupport support = contact_support(contact);
    ContactData<double> rows(contact, support);
    const Kinematics<double>& kinA = on_A.of(contact.A.robot);
    const Kinematics<double>* kinB = contact.B.robot < 0                  ? nullptr
                                     : contact.B.robot == contact.A.robot ? &kinA
                                                                          : &on_B.of(contact.B.robot);
    contact_rows<double>(scene, contact, support, kinA, kinB, rows);
    look(static_cast<int>(c), support, rows);
  }
}

template <class Look>
void each_contact_at(const Scene& scene, const std::vector<char>& active, const Eigen::Ref<const Eigen::VectorXd>& q,
                     const double* v, Look&& look) {  // calls look(c, rows), without J
  each_contact_at(
      scene, active, q, v, [](const Contact&) { return ContactSupport(); },
      [&](int c, const ContactSupport&, const ContactData<double>& rows) { look(c, rows); });
}

}  // namespace manycontact::internal
