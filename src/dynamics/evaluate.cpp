#include "internal.hpp"
#include "manycontact/algorithm/rnea.hpp"

namespace manycontact::internal {

void evaluate(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& u, SceneData& data,
              IslandData& d) {
  const int* iperm = d.system.pattern->iperm.data();
  double* b = d.system.b.data();
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const Robot& robot = scene.robots[d.island.robots[k]];
    const Model& model = *robot.model;
    RobotData& r = data.robots[d.island.robots[k]];
    forward_kinematics<double>(model, robot.base, q.segment(robot.idx_q, model.nq), r.kin);
    forward_accelerations<double>(model, v.segment(robot.idx_v, model.nv), nullptr, scene.gravity, r.kin);
    inverse_dynamics<double>(model, r.kin, nullptr, {}, r.f, r.h);  // h = ID(q, v, 0)
    crba<double>(model, r.kin, r.Yc, r.M.data());
    const int first = model.first_actuated();
    const int* to = iperm + d.island.dof_offset[k];
    for (int i = 0; i < model.nv; ++i) b[to[i]] = (i < first ? 0.0 : u[robot.idx_u + i - first]) - r.h[i];
  }
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k) {
    const int c = d.island.contacts[k];
    const Contact& contact = scene.contacts[c];
    ContactData<double>& rows = data.contacts[c];
    contact_rows<double>(scene, contact, data.supports[c], data.robots[contact.A.robot].kin,
                         contact.B.robot < 0 ? nullptr : &data.robots[contact.B.robot].kin, rows);
    const int* to = iperm + d.island.nv + d.island.row_offset[k];
    for (int i = 0; i < rows.a0.size(); ++i) b[to[i]] = -rows.a0[i];
  }
  assemble(d.M, d.J, scene.damping, d.system);
}

}  // namespace manycontact::internal
