#include "steps.hpp"

// The right-hand sides -dr of an island's derivatives, written into its panel.

namespace manycontact::internal {

namespace {

using V6 = Vec6<double>;
using Panel = IslandDerivatives::Panel;

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
    for (int i = out.request.tau ? 0 : model.first_actuated(), k = uo; i < model.nv; ++i)
      X(o + i, out.u_first + k++) = 1;
}

// -dr2 of one contact.
void contact_columns(const Contact& contact, const ContactData<double>& rows, const ContactDerivatives& d,
                     const std::vector<int>& columns, int oA, int row, IslandDerivatives& out) {
  Panel& X = out.X;
  const int n = contact.rows();
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (out.request.v) X.block(row, out.v_first + columns[k], n, 1).noalias() -= rows.W * d.dx_dv.col(k);
    if (out.request.q) X.block(row, out.q_first + columns[k], n, 1).noalias() -= rows.W * d.dx_dq.col(k);
  }
  if (!d.turns || !out.request.q) return;
  for (std::size_t i = 0; i < d.chain_a.size(); ++i) {
    const V6 dx = turned(d.turn.col(i), d.x);
    X.block(row, out.q_first + oA + d.chain_a[i], n, 1).noalias() -= rows.W * dx;
  }
}

}  // namespace

void force_columns(const ContactData<double>& rows, const ContactDerivatives& d, const std::vector<int>& columns,
                   int oA, int oB, Eigen::Ref<Panel, 0, Eigen::OuterStride<>> X) {
  for (std::size_t k = 0; k < columns.size() && !d.chain_b.empty(); ++k) {
    const V6 dF = cross_force(rows.Jl.col(k), d.F);
    for (std::size_t j = 0; j < d.chain_b.size(); ++j) X(oB + d.chain_b[j], columns[k]) -= d.S_b.col(j).dot(dF);
  }
  if (!d.turns) return;
  for (std::size_t i = 0; i < d.chain_a.size(); ++i) {
    const V6 dF = turned(d.turn.col(i), d.F);
    for (std::size_t k = 0; k < columns.size(); ++k) X(columns[k], oA + d.chain_a[i]) -= rows.Jl.col(k).dot(dF);
  }
}

void derivative_rhs(const Scene& scene, const Linearisation& terms, const IslandWork& d, IslandDerivatives& out) {
  const Island& island = d.island;
  out.X.setZero();
  for (std::size_t k = 0; k < island.robots.size(); ++k)
    robot_columns(*scene.robots[island.robots[k]].model, terms.of(island.robots[k]).rnea, island.dof_offset[k],
                  out.u_offset[k], out);
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    const Contact& contact = scene.contacts[c];
    const std::vector<int>& columns = d.shape->support().columns[k];
    const int oA = first_dof(island, contact.A), oB = first_dof(island, contact.B);
    contact_columns(contact, terms.contacts[c], terms.derivatives[c], columns, oA, island.nv + island.row_offset[k],
                    out);
    if (out.request.q)
      force_columns(terms.contacts[c], terms.derivatives[c], columns, oA, oB,
                    out.X.block(0, out.q_first, island.nv, island.nv));
  }
}

}  // namespace manycontact::internal
