#include "steps.hpp"

namespace manycontact::internal {

void evaluate_robot(const Scene& scene, const ConstVector& q, const ConstVector& v, Workspace& w, int i) {
  const Robot& robot = scene.robots[i];
  const Model& model = *robot.model;
  RobotData& r = w.robots[i];
  evaluate_bias<double>(model, robot.base, q.segment(robot.idx_q, model.nq), v.segment(robot.idx_v, model.nv),
                        scene.gravity, r);
  evaluate_inertia<double>(model, r, nullptr, r.M.data());
  r.known = true;
}

void evaluate_contact(const Scene& scene, Workspace& w, int c) {
  const Contact& contact = scene.contacts[c];
  contact_rows<double>(scene, contact, w.supports[c], w.robots[contact.A.robot].kin,
                       contact.B.robot < 0 ? nullptr : &w.robots[contact.B.robot].kin, w.contacts[c]);
}

void evaluate(const Scene& scene, const ConstVector& q, const ConstVector& v, Workspace& w, const Island& island) {
  for (int r : island.robots) evaluate_robot(scene, q, v, w, r);
  for (int c : island.contacts) evaluate_contact(scene, w, c);
}

void assemble_island(const Scene& scene, const SceneData& data, Order order, double damping, IslandWork& d) {
  const Workspace& w = *data.workspace;
  const std::shared_ptr<const KktPattern>& pattern = d.shape->pattern(order);
  if (d.K.pattern != pattern) d.K.reset(pattern);
  if (d.v.b.size() != static_cast<std::size_t>(d.K.size())) d.v.resize(d.K.size());
  assemble(d.M, d.J, damping, d.K);
  d.K.row_size = 0;
  for (int c : d.island.contacts) d.K.row_size = std::max(d.K.row_size, motion_size(scene.contacts[c], w.contacts[c]));

  const int* iperm = pattern->iperm.data();  // b = [tau - h; wanted - a0]
  double* b = d.v.b.data();
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const Robot& robot = scene.robots[d.island.robots[k]];
    const Eigen::VectorXd& h = w.robots[d.island.robots[k]].h;
    const int* to = iperm + d.island.dof_offset[k];
    for (int i = 0; i < robot.model->nv; ++i) b[to[i]] = data.tau[robot.idx_v + i] - h[i];
  }
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k) {
    const int c = d.island.contacts[k];
    const auto& a0 = w.contacts[c].a0;
    const int* to = iperm + d.island.nv + d.island.row_offset[k];
    for (int i = 0; i < a0.size(); ++i) b[to[i]] = wanted_in(data, c, i) - a0[i];
  }
}

}  // namespace manycontact::internal
