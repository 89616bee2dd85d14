// What each cluster answers to its bonds' y: its part of S.

#include "dense.hpp"
#include "manycontact/lq/bond_schur.hpp"

namespace manycontact::lq {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using MatrixMap = Eigen::Map<MatrixXd>;

MatrixMap as_matrix(std::vector<double>& scratch, Index rows, Index cols) { return {scratch.data(), rows, cols}; }

// Rows of M, blocks' states, from the order of one cluster to that of another with the same blocks.
void reorder_rows(const Problem& problem, const Cluster& from, const Cluster& to, const MatrixMap& M, MatrixMap out) {
  for (std::size_t i = 0; i < from.blocks.size(); ++i)
    for (std::size_t j = 0; j < to.blocks.size(); ++j)
      if (from.blocks[i] == to.blocks[j]) {
        const int n = problem.nx[from.blocks[i]];
        out.middleRows(to.x_start[j], n) = M.middleRows(from.x_start[i], n);
      }
}

}  // namespace

// Gx, Gu, E of the node's y, and its own block [R_ww D_w^T; D_w 0] in S.
void BondSchur::add_terms_of_y(const Problem& problem, int k, const BondNode& node) {
  const Cluster& c = riccati_.plan()[k][node.cluster];
  const bool last = k == problem.horizon();
  MatrixMap Gx = as_matrix(Gx_, c.nx, node.size), Gu = as_matrix(Gu_, c.nu, node.size);
  MatrixMap E = as_matrix(E_, c.nx, node.size), S = as_matrix(S_, node.size, node.size);
  for (MatrixMap* M : {&Gx, &Gu, &E, &S}) M->setZero();
  const auto part_of = [&](int bond, bool is_w) {
    for (const BondPart& part : node.parts)
      if (part.bond == bond && part.is_w == is_w) return part.at;
    return 0;  // of size zero
  };
  for (const Member& m : c.members) {
    const Group& g = problem.knots[k].groups[m.group];
    const Piece& u = m.v.front();
    Index w = u.size, row = 0;
    for (int b : g.bonds) {
      const Bond& bond = problem.knots[k].bonds[b];
      const int yw = part_of(b, true), ymu = part_of(b, false);
      Gx.block(m.x, yw, m.nx, bond.size) += g.S.middleCols(w, bond.size);
      Gx.block(m.x, ymu, m.nx, bond.rows) += g.C.middleRows(row, bond.rows).transpose();
      Gu.block(u.to, yw, u.size, bond.size) += g.R.block(0, w, u.size, bond.size);
      Gu.block(u.to, ymu, u.size, bond.rows) += g.D.block(row, 0, bond.rows, u.size).transpose();
      if (!last) E.block(m.x, yw, m.nx, bond.size) += g.B.middleCols(w, bond.size);
      Index other = u.size;
      for (int a : g.bonds) {
        const int size = problem.knots[k].bonds[a].size, ya = part_of(a, true);
        S.block(ya, yw, size, bond.size) += g.R.block(other, w, size, bond.size);
        S.block(ymu, ya, bond.rows, size) += g.D.block(row, other, bond.rows, size);
        S.block(ya, ymu, size, bond.rows) += g.D.block(row, other, bond.rows, size).transpose();
        other += size;
      }
      w += bond.size;
      row += bond.rows;
    }
  }
}

// F, pi, theta of knot k and S_kk; W of the next knot.
void BondSchur::respond_at(const Problem& problem, int cluster, int k) {
  const BondNode& node = graph_.nodes[cluster][k];
  const Cluster& c = riccati_.plan()[k][node.cluster];
  const Riccati::Policy& policy = riccati_.policy(k, node.cluster);
  const bool last = k == problem.horizon();
  const Index n = c.nx, y = node.size;
  MatrixMap W = as_matrix(W_, n, n), F = as_matrix(F_[k], n, n), FW = as_matrix(FW_, n, n);
  MatrixMap B = as_matrix(U_, n, c.nu);
  if (!last) {
    B.setZero();
    F.setZero();
    for (const Member& m : c.members) {
      const Group& g = problem.knots[k].groups[m.group];
      const Piece& u = m.v.front();
      B.block(m.x, u.to, m.nx, u.size) = g.B.leftCols(u.size);
      F.block(m.x, m.x, m.nx, m.nx) = g.A;
      add_AB(F.middleRows(m.x, m.nx), 1, g.B.leftCols(u.size), policy.K.middleRows(u.to, u.size));
    }
    FW.setZero();
    add_AB(FW, 1, F, W);
  }

  if (y > 0) {
    add_terms_of_y(problem, k, node);
    MatrixMap Gx = as_matrix(Gx_, n, y), Gu = as_matrix(Gu_, c.nu, y), E = as_matrix(E_, n, y);
    MatrixMap PE = as_matrix(PE_, n, y), Y = as_matrix(Y_, c.nu, y), S = as_matrix(S_, y, y);
    MatrixMap pi = as_matrix(pi_[k], n, y), theta = as_matrix(theta_[k], n, y);
    pi = Gx;
    if (!last) {
      const Eigen::Ref<const MatrixXd> P = riccati_.next_value(problem, k, node.cluster);
      PE.setZero();
      add_AB(PE, 1, P, E);
      add_AtB(pi, 1, policy.K, Gu);  // pi = Gx + K^T Gu + F^T P+ E
      add_AtB(pi, 1, F, PE);
      Y = Gu;
      add_AtB(Y, 1, B, PE);  // g
      solve_L(policy.L, Y);
      add_lower_AtB(S, 1, E, PE);
      add_lower_AtB(S, -1, Y, Y);  // g^T Qvv^-1 g
      theta = E;
      solve_Lt(policy.L, Y);
      add_AB(theta, -1, B, Y);
      add_AB(theta, -1, FW, pi);
    }
    MatrixMap& Wpi = PE;
    Wpi.setZero();
    add_AB(Wpi, 1, W, pi);
    add_lower_AtB(S, -1, pi, Wpi);
    copy_lower_to_upper(S);
    for (std::size_t a = 0; a < node.parts.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const BondPart &i = node.parts[a], &j = node.parts[b];
        schur_.add(i.vertex, i.offset, j.vertex, j.offset, S.block(i.at, j.at, i.size, j.size));
      }
  }

  if (last) return;
  solve_Lt_right(policy.L, B);  // W+ = F W F^T + B Qvv^-1 B^T
  W.setZero();
  add_lower_ABt(W, 1, FW, F);
  add_lower_ABt(W, 1, B, B);
  copy_lower_to_upper(W);
  if (c.next_in_order) return;
  const Cluster& next = riccati_.plan()[k + 1][graph_.nodes[cluster][k + 1].cluster];
  reorder_rows(problem, c, next, W, FW);
  W = FW.transpose();
  reorder_rows(problem, c, next, W, FW);
  W = FW;
}

// S_jl for all j < l, y_l of one vertex: V holds F_(j+1)^T ... F_(l-1)^T pi_l of all l > j, in the order of knot j + 1;
// they are the vertex' last columns.
void BondSchur::sweep(const Problem& problem, int cluster, int vertex) {
  const int size = graph_.vertices[vertex].size;
  int first = size;
  std::vector<double>*V = &V_, *scratch = &V_next_;
  for (int k = problem.horizon(); k >= 0; --k) {
    const BondNode& node = graph_.nodes[cluster][k];
    const Cluster& c = riccati_.plan()[k][node.cluster];
    const Index n = c.nx;
    if (first < size) {
      if (!c.next_in_order) {
        const Cluster& next = riccati_.plan()[k + 1][graph_.nodes[cluster][k + 1].cluster];
        reorder_rows(problem, next, c, as_matrix(*V, n, size), as_matrix(*scratch, n, size));
        std::swap(V, scratch);
      }
      const auto later = as_matrix(*V, n, size).rightCols(size - first);
      if (node.size > 0) {
        MatrixMap S = as_matrix(S_, node.size, size - first);
        S.setZero();
        add_AtB(S, 1, as_matrix(theta_[k], n, node.size), later);
        for (const BondPart& i : node.parts) schur_.add(i.vertex, i.offset, vertex, first, S.middleRows(i.at, i.size));
      }
      if (k > 0) {
        auto V_k = as_matrix(*scratch, n, size).rightCols(size - first);
        V_k.setZero();
        add_AtB(V_k, 1, as_matrix(F_[k], n, n), later);
        std::swap(V, scratch);
      }
    }
    for (const BondPart& part : node.parts)
      if (part.vertex == vertex) {
        as_matrix(*V, n, size).middleCols(part.offset, part.size) =
            as_matrix(pi_[k], n, node.size).middleCols(part.at, part.size);
        first = std::min(first, part.offset);
      }
  }
}

void BondSchur::respond(const Problem& problem, int cluster) {
  if (graph_.of_cluster[cluster].empty()) return;
  const Cluster& c = riccati_.plan()[0][graph_.nodes[cluster][0].cluster];
  as_matrix(W_, c.nx, c.nx).setZero();
  for (int k = 0; k <= problem.horizon(); ++k) respond_at(problem, cluster, k);
  for (const int vertex : graph_.of_cluster[cluster]) sweep(problem, cluster, vertex);
}

}  // namespace manycontact::lq
