#pragma once
// Functions that write the right-hand sides -dr of K [da; -df] = -dr, robot by robot and contact by contact. dr are the
// derivatives, with respect to q or v, of the residuals of an island's dynamics and contact rows. A block X of -dr has
// one column per coordinate. S: double, or a SIMD pack of robots.

#include "manycontact/detail/contact/derivatives.hpp"

namespace manycontact::internal {

/// Writes -dID/dq or -dID/dv (ID: inverse dynamics) into a robot's block X. lower, upper: triangles of dID, as in M.
template <class S, class Block>
void robot_columns(const Model& model, const S* lower, const S* upper, Block&& X) {
  for (int i = 0; i < model.nv; ++i) {
    int at = model.M_begin[i];
    for (int j = i; j >= 0; j = model.dof_parent[j], ++at) {
      X(j, i) = -upper[at];
      X(i, j) = -lower[at];
    }
  }
}

/// Subtracts W dx from a contact's rows X. W selects the contact's rows from the relative motion x of its frames
/// (ContactData); dx: derivatives dx_dq or dx_dv of x (ContactDerivatives), a column per coordinate.
template <class S, class Block>
void contact_columns(const ContactData<S>& rows, const Mat6X<S>& dx, const std::vector<int>& columns, Block&& X) {
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (int i = 0; i < rows.W.rows(); ++i) X(i, columns[k]) -= rows.W.row(i).dot(dx.col(k));
}

/// Subtracts dW/dq x, due to world axes that rotate relative to A, from a contact's rows X. oA: A's first coordinate.
template <class S, class Block>
void turning_columns(const ContactData<S>& rows, const ContactDerivativesOf<S>& d, int oA, Block&& X) {
  if (!d.turns) return;
  for (std::size_t i = 0; i < d.chain_a.size(); ++i) {
    const Vec6<S> dx = turned<S>(d.turn.col(i), d.x);
    for (int r = 0; r < rows.W.rows(); ++r) X(r, oA + d.chain_a[i]) -= rows.W.row(r).dot(dx);
  }
}

/// Corrects X = -dr1/dq (r1: residual of dynamics), computed as if contact forces moved with their bodies. In fact, B's
/// force moves with A, and does not rotate in a world-aligned frame. oA, oB: first coordinates of A's and B's robots.
template <class S, class Block>
void force_columns(const ContactData<S>& rows, const ContactDerivativesOf<S>& d, const std::vector<int>& columns,
                   int oA, int oB, Block&& X) {
  for (std::size_t k = 0; k < columns.size() && !d.chain_b.empty(); ++k) {
    const Vec6<S> dF = cross_force(rows.Jl.col(k), d.F);
    for (std::size_t j = 0; j < d.chain_b.size(); ++j) X(oB + d.chain_b[j], columns[k]) -= d.S_b.col(j).dot(dF);
  }
  if (!d.turns) return;
  for (std::size_t i = 0; i < d.chain_a.size(); ++i) {
    const Vec6<S> dF = turned<S>(d.turn.col(i), d.F);
    for (std::size_t k = 0; k < columns.size(); ++k) X(columns[k], oA + d.chain_a[i]) -= rows.Jl.col(k).dot(dF);
  }
}

}  // namespace manycontact::internal
