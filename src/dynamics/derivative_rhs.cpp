#include "internal.hpp"

// The right-hand sides -dr of an island's derivatives, written into its panel.

namespace manycontact::internal {

namespace {

using V6 = Vec6<double>;
using Panel = IslandDerivatives::Panel;

// Forces of the contacts on the bodies of the island's robots, in their tree frames.
void contact_forces(const Scene& scene, SceneData& data, const Island& island) {
  DerivativeData& dd = *data.derivatives;
  for (int r : island.robots) std::fill(dd.of(r).fext.begin(), dd.of(r).fext.end(), V6(V6::Zero()));
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    const ContactData<double>& rows = data.contacts[c];
    V6 F;
    F.noalias() = rows.W.transpose() * data.f.segment(data.f_offset[c], contact.rows());
    if (contact.A.joint >= 0) dd.of(contact.A.robot).fext[contact.A.joint] += rows.aMA.act_force(F);
    if (contact.B.robot >= 0 && contact.B.joint >= 0)
      dd.of(contact.B.robot).fext[contact.B.joint] -= rows.bMA.act_force(F);
  }
}

// -dID/dq, -dID/dv and S^T on a robot's diagonal blocks.
void robot_columns(const Model& model, const RneaDerivatives& d, int o, int uo, IslandDerivatives& out) {
  Panel& X = out.X;
  for (int i = 0; i < model.nv; ++i) {
    int at = model.M_begin[i];
    for (int j = i; j >= 0; j = model.dof_parent[j], ++at) {
      if (out.request.q) {
        X(o + j, out.q_first + o + i) = -d.dq_upper[at];
        X(o + i, out.q_first + o + j) = -d.dq_lower[at];
      }
      if (out.request.v) {
        X(o + j, out.v_first + o + i) = -d.dv_upper[at];
        X(o + i, out.v_first + o + j) = -d.dv_lower[at];
      }
    }
  }
  if (out.request.u)
    for (int i = model.first_actuated(); i < model.nv; ++i) X(o + i, out.u_first + uo + i - model.first_actuated()) = 1;
}

// -dr2 of one contact, and what its force adds to -dr1 beyond forces fixed to their bodies: B's half moves with A, and a
// world-aligned frame does not turn.
void contact_columns(const Contact& contact, const ContactData<double>& rows, const ContactDerivatives& d,
                     const std::vector<int>& columns, int oA, int oB, int row, IslandDerivatives& out) {
  Panel& X = out.X;
  const int n = contact.rows();
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (out.request.v) X.block(row, out.v_first + columns[k], n, 1).noalias() -= rows.W * d.dx_dv.col(k);
    if (!out.request.q) continue;
    X.block(row, out.q_first + columns[k], n, 1).noalias() -= rows.W * d.dx_dq.col(k);
    if (d.chain_b.empty()) continue;
    const V6 dF = cross_force(rows.Jl.col(k), d.F);
    for (std::size_t j = 0; j < d.chain_b.size(); ++j)
      X(oB + d.chain_b[j], out.q_first + columns[k]) -= d.S_b.col(j).dot(dF);
  }
  if (!d.turns || !out.request.q) return;
  for (std::size_t i = 0; i < d.chain_a.size(); ++i) {
    const Vec3<double> th = d.turn.col(i);
    const int column = out.q_first + oA + d.chain_a[i];
    V6 dx, dF;
    dx << th.cross(d.x.head<3>()), th.cross(d.x.tail<3>());
    dF << th.cross(d.F.head<3>()), th.cross(d.F.tail<3>());
    X.block(row, column, n, 1).noalias() -= rows.W * dx;
    for (std::size_t k = 0; k < columns.size(); ++k) X(columns[k], column) -= rows.Jl.col(k).dot(dF);
  }
}

}  // namespace

void derivative_terms(const Scene& scene, SceneData& data, const IslandData& d) {
  DerivativeData& dd = *data.derivatives;
  contact_forces(scene, data, d.island);
  for (int r : d.island.robots) {
    const Robot& robot = scene.robots[r];
    RobotData& rd = data.robots[r];
    forward_accelerations<double>(*robot.model, data.v.segment(robot.idx_v, robot.model->nv),
                                  data.a.data() + robot.idx_v, scene.gravity, rd.kin);
    rnea_derivatives(*robot.model, rd.kin, rd.Yc, dd.of(r).fext, dd.of(r).rnea);
  }
  for (int c : d.island.contacts) {
    const Contact& contact = scene.contacts[c];
    const int A = contact.A.robot, B = contact.B.robot;
    contact_derivatives(scene, contact, data.supports[c], data.robots[A].kin, B < 0 ? nullptr : &data.robots[B].kin,
                        dd.of(A).rnea, B < 0 ? nullptr : &dd.of(B).rnea,
                        data.f.segment(data.f_offset[c], contact.rows()), dd.rows[c], dd.contacts[c]);
  }
}

void derivative_rhs(const Scene& scene, SceneData& data, const IslandData& d, IslandDerivatives& out) {
  const Island& island = d.island;
  DerivativeData& dd = *data.derivatives;
  out.X.setZero();
  for (std::size_t k = 0; k < island.robots.size(); ++k)
    robot_columns(*scene.robots[island.robots[k]].model, dd.of(island.robots[k]).rnea, island.dof_offset[k],
                  out.u_offset[k], out);
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    const Contact& contact = scene.contacts[c];
    const int oA = island.dof_offset[local_robot(island, contact.A.robot)];
    const int oB = contact.B.robot < 0 ? 0 : island.dof_offset[local_robot(island, contact.B.robot)];
    contact_columns(contact, dd.rows[c], dd.contacts[c], d.support.columns[k], oA, oB, island.nv + island.row_offset[k],
                    out);
  }
}

}  // namespace manycontact::internal
