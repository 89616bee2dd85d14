#include "bodies.hpp"

#include <stdexcept>

#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact::bench {

namespace {

int body_of(const std::vector<int>& first, const Attachment& at) {
  return at.robot < 0 || at.joint < 0 ? -1 : first[at.robot] + at.joint;
}

std::vector<int> first_bodies(const Scene& scene) {
  std::vector<int> first;
  int n = 0;
  for (const Robot& r : scene.robots) {
    first.push_back(n);
    n += r.model->njoints();
  }
  return first;
}

}  // namespace

std::string strange(const Posed& s) {
  for (const Robot& r : s.scene.robots)
    for (const Joint& j : r.model->joints)
      if (j.type != JointType::kRevolute && j.type != JointType::kFloating) return "joints other than revolute ones";
  return {};
}

std::vector<Body> bodies_of(const Posed& s) {
  std::vector<Body> bodies;
  for (const Robot& r : s.scene.robots) {
    const Model& model = *r.model;
    const int first = static_cast<int>(bodies.size());
    Kinematics<double> kin(model);
    const Eigen::VectorXd q = s.q.segment(r.idx_q, model.nq);
    forward_kinematics<double>(model, r.base, q, kin);
    for (int i = 0; i < model.njoints(); ++i) {
      const Joint& j = model.joints[i];
      Body b;
      b.parent = j.parent < 0 ? -1 : first + j.parent;
      b.type = j.type;
      b.in_world = {kin.oMi[i].R, kin.origin(static_cast<int>(i)) + kin.oMi[i].p};
      b.in_parent = b.parent < 0 ? b.in_world : bodies[b.parent].in_world.inverse() * b.in_world;
      b.axis = j.axis;
      b.mass = j.inertia.m;
      b.com = j.inertia.h / j.inertia.m;
      b.inertia = j.inertia.I - b.mass * (b.com.squaredNorm() * Mat3<double>::Identity() - b.com * b.com.transpose());
      b.idx_v = r.idx_v + j.idx_v;
      b.idx_u = j.type == JointType::kFloating ? -1 : r.idx_u + model.torque_index(j);
      bodies.push_back(b);
    }
  }
  return bodies;
}

std::vector<Hold> holds_of(const Posed& s, const std::vector<Body>& bodies) {
  const std::vector<int> first = first_bodies(s.scene);
  std::vector<Hold> holds;
  for (const Contact& c : s.scene.contacts) {
    if (c.type != ContactType::k3D && c.type != ContactType::k6D)
      throw std::invalid_argument("contacts of type " + to_string(c.type) + " are not compared");
    Hold h{c.type == ContactType::k3D, body_of(first, c.A), body_of(first, c.B), c.A.placement, {}};
    const SE3<double> place = bodies[h.a].in_world * h.in_a;
    h.in_b = h.b < 0 ? place : bodies[h.b].in_world.inverse() * place;
    holds.push_back(h);
  }
  return holds;
}

}  // namespace manycontact::bench
