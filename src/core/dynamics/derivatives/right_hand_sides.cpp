#include "../internal.hpp"
#include "columns.hpp"
#include "manycontact/algorithm/joint_friction.hpp"

namespace manycontact::internal {

namespace {

// Computes derivatives of the inverse dynamics (RNEA) and of the contact rows at the last solution.
void derivative_terms(const Scene& scene, SceneData& data, const Island& island) {
  Workspace& w = *data.workspace;
  Linearisation& lin = *w.linearisation;
  contact_forces(scene, island, lin.contacts, data.f_offset, data.f,
                 [&lin](int r) -> std::vector<Vec6<double>>& { return lin.of(r).fext; });
  for (int r : island.robots)
    rnea_derivatives(*scene.robots[r].model, w.robots[r].kin, w.robots[r].Yc, lin.of(r).fext, lin.of(r).rnea);
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    const int A = contact.A.robot, B = contact.B.robot;
    // A contact's fixed end may be on a robot of another island. The terms of that robot must not be read.
    const RneaDerivatives& of_A = lin.of(moves(contact.A) ? A : B).rnea;
    const RneaDerivatives* of_B = moves(contact.B) ? &lin.of(B).rnea : nullptr;
    contact_derivatives<double>(contact, w.supports[c], w.robots[A].kin, B < 0 ? nullptr : &w.robots[B].kin, of_A, of_B,
                                data.f.segment(data.f_offset[c], contact.rows()), lin.contacts[c], lin.derivatives[c]);
    lin.state[c] = w.state;
  }
}

}  // namespace

void right_hand_sides(const Scene& scene, SceneData& data, const IslandWork& d, IslandDerivatives& out) {
  derivative_terms(scene, data, d.island);
  out.X.setZero();
  const Linearisation& terms = *data.workspace->linearisation;
  const Island& island = d.island;
  const DerivativeRequest& request = out.request;
  AlignedPanel& X = out.X;
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Model& model = *scene.robots[island.robots[k]].model;
    const RneaDerivatives& rnea = terms.of(island.robots[k]).rnea;
    const int o = island.dof_offset[k], nv = model.nv;
    if (request.q)
      robot_columns(model, rnea.dq_lower.data(), rnea.dq_upper.data(), X.block(o, out.q_first + o, nv, nv));
    if (request.v)
      robot_columns(model, rnea.dv_lower.data(), rnea.dv_upper.data(), X.block(o, out.v_first + o, nv, nv));
    for (int i = 0; request.v && has_friction(model) && i < nv; ++i)
      X(o + i, out.v_first + o + i) -= friction_slope(model, i, data.v[scene.robots[island.robots[k]].idx_v + i]);
    const int u = out.u_first + out.u_offset[k];
    for (int i = 0; request.u && i < (request.tau ? nv : model.nu()); ++i)
      X(o + (request.tau ? i : model.actuated[i]), u + i) = 1;
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k], row = island.nv + island.row_offset[k];
    const Contact& contact = scene.contacts[c];
    const ContactData<double>& rows = terms.contacts[c];
    const ContactDerivatives& derivatives = terms.derivatives[c];
    const std::vector<int>& columns = d.shape->support().columns[k];
    if (request.v)
      contact_columns(rows, derivatives.dx_dv, columns, X.block(row, out.v_first, contact.rows(), island.nv));
    if (!request.q) continue;
    const int oA = first_dof(island, contact.A), oB = first_dof(island, contact.B);
    contact_columns(rows, derivatives.dx_dq, columns, X.block(row, out.q_first, contact.rows(), island.nv));
    turning_columns(rows, derivatives, oA, X.block(row, out.q_first, contact.rows(), island.nv));
    force_columns(rows, derivatives, columns, oA, oB, X.block(0, out.q_first, island.nv, island.nv));
  }
}

}  // namespace manycontact::internal
