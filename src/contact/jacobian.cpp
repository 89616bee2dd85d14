#include "manycontact/contact/jacobian.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "manycontact/contact/rows.hpp"
#include "manycontact/model/expect_size.hpp"

namespace manycontact {

namespace {

using ConstRef = Eigen::Ref<const Eigen::VectorXd>;

std::vector<char> flags(const char* function, const Scene& scene, std::vector<char> active) {
  if (active.empty())
    for (const Contact& contact : scene.contacts) active.push_back(contact.active);
  expect_size(function, "active", static_cast<Eigen::Index>(active.size()),
              static_cast<Eigen::Index>(scene.contacts.size()));
  return active;
}

// look(contact's number, support, rows) for the contacts with wanted(c), at q and v (nullptr: at rest).
template <class Wanted, class Look>
void each_contact(const Scene& scene, const ConstRef& q, const double* v, Wanted&& wanted, Look&& look) {
  std::vector<std::unique_ptr<Kinematics<double>>> kin(scene.robots.size());
  const auto of = [&](int r) -> const Kinematics<double>* {
    if (r < 0) return nullptr;
    if (!kin[r]) {
      const Robot& robot = scene.robots[r];
      const Model& model = *robot.model;
      const Eigen::VectorXd own = v ? Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(v + robot.idx_v, model.nv))
                                    : Eigen::VectorXd(Eigen::VectorXd::Zero(model.nv));
      kin[r] = std::make_unique<Kinematics<double>>(model);
      forward_kinematics<double>(model, robot.base, q.segment(robot.idx_q, model.nq), *kin[r]);
      forward_accelerations<double>(model, own, nullptr, scene.gravity, *kin[r]);
    }
    return kin[r].get();
  };
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (!wanted(c)) continue;
    const Contact& contact = scene.contacts[c];
    const ContactSupport support = contact_support(scene, contact);
    ContactData<double> rows(contact, support);
    contact_rows<double>(scene, contact, support, *of(contact.A.robot), of(contact.B.robot), rows);
    look(c, support, rows);
  }
}

Eigen::Index count_rows(const Scene& scene, const std::vector<char>& active) {
  Eigen::Index n = 0;
  for (std::size_t c = 0; c < active.size(); ++c)
    if (active[c]) n += scene.contacts[c].rows();
  return n;
}

}  // namespace

Eigen::MatrixXd contact_jacobian(const Scene& scene, const ConstRef& q, const std::vector<char>& given) {
  const std::vector<char> active = flags("contact_jacobian", scene, given);
  expect_size("contact_jacobian", "q", q.size(), scene.nq);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(count_rows(scene, active), scene.nv);
  Eigen::Index row = 0;
  each_contact(
      scene, q, nullptr, [&](std::size_t c) { return active[c]; },
      [&](std::size_t c, const ContactSupport& support, const ContactData<double>& d) {
        const Contact& contact = scene.contacts[c];
        Eigen::Index column = 0;
        for (const int i : support.a)
          J.col(scene.robots[contact.A.robot].idx_v + i).segment(row, contact.rows()) = d.J.col(column++);
        for (const int i : support.b)
          J.col(scene.robots[contact.B.robot].idx_v + i).segment(row, contact.rows()) = d.J.col(column++);
        row += contact.rows();
      });
  return J;
}

Eigen::VectorXd contact_drift(const Scene& scene, const ConstRef& q, const ConstRef& v,
                              const std::vector<char>& given) {
  const std::vector<char> active = flags("contact_drift", scene, given);
  expect_size("contact_drift", "q", q.size(), scene.nq);
  expect_size("contact_drift", "v", v.size(), scene.nv);
  Eigen::VectorXd a0(count_rows(scene, active));
  Eigen::Index row = 0;
  each_contact(
      scene, q, v.data(), [&](std::size_t c) { return active[c]; },
      [&](std::size_t, const ContactSupport&, const ContactData<double>& d) {
        a0.segment(row, d.a0.size()) = d.a0;
        row += d.a0.size();
      });
  return a0;
}

std::vector<Vec6<double>> contact_forces_on_bodies(const Scene& scene, const ConstRef& q, const ConstRef& f,
                                                   const std::vector<int>& f_offset) {
  const char* const name = "contact_forces_on_bodies";
  expect_size(name, "q", q.size(), scene.nq);
  expect_size(name, "f_offset", static_cast<Eigen::Index>(f_offset.size()),
              static_cast<Eigen::Index>(scene.contacts.size()));
  for (std::size_t c = 0; c < f_offset.size(); ++c)
    if (f_offset[c] + scene.contacts[c].rows() > f.size() && f_offset[c] >= 0)
      throw std::invalid_argument(std::string(name) + ": f does not fit f_offset");
  std::vector<int> first;  // body of each robot
  int bodies = 0;
  for (const Robot& robot : scene.robots) {
    first.push_back(bodies);
    bodies += robot.model->njoints();
  }
  std::vector<Vec6<double>> out(static_cast<std::size_t>(bodies), Vec6<double>::Zero());
  const auto add = [&](const Attachment& at, const Vec6<double>& wrench) {
    if (at.robot >= 0 && at.joint >= 0) out[first[at.robot] + at.joint] += at.placement.act_force(wrench);
  };
  each_contact(
      scene, q, nullptr, [&](std::size_t c) { return f_offset[c] >= 0; },
      [&](std::size_t c, const ContactSupport&, const ContactData<double>& d) {
        const Contact& contact = scene.contacts[c];
        const Vec6<double> on_A = d.W.transpose() * f.segment(f_offset[c], contact.rows());
        add(contact.A, on_A);
        add(contact.B, -d.G.act_force(on_A));  // in the axes of B', about its origin
      });
  return out;
}

}  // namespace manycontact
