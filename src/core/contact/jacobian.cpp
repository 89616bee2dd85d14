#include "manycontact/contact/jacobian.hpp"

#include <stdexcept>
#include <string>

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/contact/motion_of.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact {

namespace {

using ConstRef = Eigen::Ref<const Eigen::VectorXd>;

std::vector<char> flags(const char* function, const Scene& scene, std::vector<char> active) {
  if (active.empty()) active = active_contacts(scene);
  expect_size(function, "active", static_cast<Eigen::Index>(active.size()),
              static_cast<Eigen::Index>(scene.contacts.size()));
  return active;
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
  expect_configuration("contact_jacobian", "q", q, scene);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(count_rows(scene, active), scene.nv);
  Eigen::Index row = 0;
  internal::each_contact_at(
      scene, active, q, nullptr, [&](const Contact& contact) { return contact_support(scene, contact); },
      [&](int c, const ContactSupport& support, const ContactData<double>& d) {
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

Eigen::VectorXd contact_bias_acceleration(const Scene& scene, const ConstRef& q, const ConstRef& v,
                                          const std::vector<char>& given) {
  const std::vector<char> active = flags("contact_bias_acceleration", scene, given);
  expect_configuration("contact_bias_acceleration", "q", q, scene);
  expect_numbers("contact_bias_acceleration", "v", v, scene.nv);
  Eigen::VectorXd a0(count_rows(scene, active));
  Eigen::Index row = 0;
  internal::each_contact_at(scene, active, q, v.data(), [&](int, const ContactData<double>& d) {
    a0.segment(row, d.a0.size()) = d.a0;
    row += d.a0.size();
  });
  return a0;
}

std::vector<Vec6<double>> contact_forces_on_bodies(const Scene& scene, const ConstRef& q, const ConstRef& f,
                                                   const std::vector<int>& f_offset) {
  const char* const name = "contact_forces_on_bodies";
  expect_configuration(name, "q", q, scene);
  expect_size(name, "f_offset", static_cast<Eigen::Index>(f_offset.size()),
              static_cast<Eigen::Index>(scene.contacts.size()));
  for (std::size_t c = 0; c < f_offset.size(); ++c)
    if (f_offset[c] + scene.contacts[c].rows() > f.size() && f_offset[c] >= 0)
      throw std::invalid_argument(std::string(name) +
                                  ": f has fewer numbers than f_offset requires, both of one solve are expected");
  std::vector<int> first;  // one entry per robot: the number of its first body
  int bodies = 0;
  for (const Robot& robot : scene.robots) {
    first.push_back(bodies);
    bodies += robot.model->njoints();
  }
  std::vector<Vec6<double>> out(static_cast<std::size_t>(bodies), Vec6<double>::Zero());
  const auto add = [&](const Attachment& at, const Vec6<double>& wrench) {
    if (moves(at)) out[first[at.robot] + at.joint] += at.placement.act_force(wrench);
  };
  std::vector<char> active;
  for (const int first_row : f_offset) active.push_back(first_row >= 0);
  internal::each_contact_at(scene, active, q, nullptr, [&](int c, const ContactData<double>& d) {
    const Contact& contact = scene.contacts[c];
    const Vec6<double> on_A = d.W.transpose() * f.segment(f_offset[c], contact.rows());
    add(contact.A, on_A);
    add(contact.B, -d.G.act_force(on_A));  // the wrench on B about its origin, in the axes of B'
  });
  return out;
}

std::vector<Vec6<double>> forces_on_bodies(const Scene& scene, const ConstRef& q, const ConstRef& v, const ConstRef& f,
                                           const std::vector<int>& f_offset, std::span<const Vec6<double>> wrenches) {
  expect_numbers("forces_on_bodies", "v", v, scene.nv);
  std::vector<Vec6<double>> out = contact_forces_on_bodies(scene, q, f, f_offset),
                            given(wrenches.begin(), wrenches.end());
  if (given.empty()) given = external_wrenches(scene);
  expect_size("forces_on_bodies", "wrenches", static_cast<Eigen::Index>(given.size()),
              static_cast<Eigen::Index>(scene.wrenches.size()));
  AppliedForces<double> applied(scene);
  find_applied_wrenches<double>(scene, q.data(), v.data(), given, applied);
  std::size_t first = 0;  // number of the robot's first body
  for (std::size_t r = 0; r < scene.robots.size(); first += scene.robots[r++].model->joints.size())
    if (applied.number[r] >= 0) {
      const auto& of = applied.robots[static_cast<std::size_t>(applied.number[r])];
      for (const int i : of.joints)
        out[first + static_cast<std::size_t>(i)] += of.kin.oMi[i].inverse().act_force(of.f[i]);
    }
  return out;
}

}  // namespace manycontact
