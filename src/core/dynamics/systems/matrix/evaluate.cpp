// Evaluates joint-space terms of an island, and assembles its K.

#include <stdexcept>

#include "../../internal.hpp"
#include "manycontact/kkt/choose.hpp"
#include "manycontact/rank/row_units.hpp"
#include "matrix.hpp"

namespace manycontact::internal {

namespace {

void evaluate_robot(const Scene& scene, const ConstVector& q, const ConstVector& v, Workspace& w, int i) {
  const Robot& robot = scene.robots[i];
  const Model& model = *robot.model;
  RobotData& r = w.robots[i];
  evaluate_bias<double>(model, robot.base, q.segment(robot.idx_q, model.nq), v.segment(robot.idx_v, model.nv),
                        scene.gravity, r);
  evaluate_inertia<double>(model, r, nullptr, r.M.data());
  r.state = w.state;
}

void evaluate_contact(const Scene& scene, Workspace& w, int c) {
  const Contact& contact = scene.contacts[c];
  contact_rows<double>(scene, contact, w.supports[c], w.robots[contact.A.robot].kin,
                       contact.B.robot < 0 ? nullptr : &w.robots[contact.B.robot].kin, w.contacts[c]);
  w.rows_state[c] = w.state;
  keep_left(w, c, w.contacts[c]);
}

}  // namespace

void make_robot(const Scene& scene, Workspace& w, int robot) {
  if (!w.robots.has(robot)) w.robots.make(robot, *scene.robots[robot].model);
}

bool is_evaluated(const Workspace& w, int robot) { return w.robots.has(robot) && w.robots[robot].state == w.state; }

void make_joint_space(const Scene& scene, Workspace& w, IslandWork& d) {
  if (d.matrix.has_terms()) return;
  d.matrix.M.clear();
  d.matrix.J.clear();
  for (int r : d.island.robots) {
    make_robot(scene, w, r);
    if (w.robots[r].M.empty()) w.robots[r].M.resize(packed_size(*scene.robots[r].model));
    d.matrix.M.emplace_back(w.robots[r].M);
  }
  for (int c : d.island.contacts) {
    if (!w.supports.has(c)) {
      const ContactSupport support = contact_support(scene, scene.contacts[c]);
      w.contacts.make(c, scene.contacts[c], support);
      w.supports.make(c, support);
    }
    const Eigen::MatrixXd& J = w.contacts[c].J;
    d.matrix.J.emplace_back(J.data(), static_cast<std::size_t>(J.size()));
  }
}

bool joint_space_fits(const IslandWork& d) { return !d.bodies || joint_space_size(*d.shape) <= kMostJointSpace; }

void check_joint_space(const IslandWork& d, const char* function, const char* instead) {
  if (!joint_space_fits(d))
    throw std::length_error(std::string(function) + ": the matrices of an island with " + std::to_string(d.island.nv) +
                            " velocities are too large" + instead);
}

void evaluate(const Scene& scene, const ConstVector& q, const ConstVector& v, Workspace& w, const Island& island) {
  for (int r : island.robots) evaluate_robot(scene, q, v, w, r);
  for (int c : island.contacts) evaluate_contact(scene, w, c);
}

void evaluate_at_state(const Scene& scene, const SceneData& data, IslandWork& d) {
  Workspace& w = *data.workspace;
  if (is_evaluated(w, d.island.robots.front())) return;
  make_joint_space(scene, w, d);
  evaluate(scene, w.q, data.v, w, d.island);
  d.matrix.tolerated = scene.tolerance > 0 && d.island.nc > 0 ? d.matrix.within.make_dependent(scene, w, d) : 0;
}

void place_at_state(const Scene& scene, const SceneData& data, const Island& island) {
  Workspace& w = *data.workspace;
  for (int r : island.robots) {
    RobotData& of = w.robots[r];
    if (of.state == w.state || of.placed == w.state) continue;
    const Robot& robot = scene.robots[r];
    forward_kinematics<double, double>(*robot.model, robot.base, w.q.segment(robot.idx_q, robot.model->nq), of.kin);
    of.placed = w.state;
  }
}

void weigh_rows(const Scene& scene, MatrixSystem& m) {
  const Island& island = m.owner.island;
  if (!has_row_units(scene, island.contacts)) return;
  for (int c : island.contacts)
    for (int i = 0; i < scene.contacts[c].rows(); ++i) m.unit.push_back(row_unit(scene, scene.contacts[c], i));
  const int* slot = m.K.pattern->J_slot.data();
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int first = island.row_offset[k], rows = scene.contacts[island.contacts[k]].rows();
    for (std::size_t entry = 0; entry < m.J[k].size(); ++entry)
      m.K.values[*slot++] *= m.unit[first + static_cast<int>(entry) % rows];
  }
  for (int k = 0; k < island.nc; ++k) m.v.b[m.K.pattern->iperm[island.nv + k]] *= m.unit[k];
}

void assemble(const Scene& scene, const SceneData& data, Order order, double damping, MatrixSystem& m) {
  const Workspace& w = *data.workspace;
  const IslandWork& d = m.owner;
  m.make_room(order);
  manycontact::assemble(m.M, m.J, damping, m.K);
  m.K.row_scale = 0;
  for (int c : d.island.contacts)
    m.K.row_scale = std::max(m.K.row_scale, motion_scale(scene.contacts[c], w.contacts[c]));

  const int* iperm = m.K.pattern->iperm.data();  // b = [tau - h; prescribed - a0]
  double* b = m.v.b.data();
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
    for (int i = 0; i < a0.size(); ++i) b[to[i]] = prescribed_in(data, c, i) - a0[i];
  }
  m.unit.clear();
}

}  // namespace manycontact::internal
