// Computes each cluster's contribution to S. F, W, pi, theta, Gx, Gu, E and y are defined in coupling_schur.hpp.

#include "dense.hpp"
#include "manycontact/lq/coupling_schur.hpp"

namespace manycontact::lq {
namespace {

// Copies the rows of M (states), ordered by the blocks of `from`, to `out`, ordered by the same blocks in `to`.
void reorder_rows(const Problem& problem, const Cluster& from, const Cluster& to, const MatrixMap& M, MatrixMap out) {
  for (std::size_t i = 0; i < from.blocks.size(); ++i)
    for (std::size_t j = 0; j < to.blocks.size(); ++j)
      if (from.blocks[i] == to.blocks[j]) {
        const int n = problem.nx[from.blocks[i]];
        out.middleRows(to.x_start[j], n) = M.middleRows(from.x_start[i], n);
      }
}

}  // namespace

// Computes Gx, Gu, E for the variables y of the node, and adds [R_ww D_w^T; D_w 0] to S.
void CouplingSchur::add_terms_of_y(const Problem& problem, int k, const CouplingNode& node) {
  const Cluster& c = riccati_.plan()[k][node.cluster];
  const bool last = k == problem.horizon();
  MatrixMap Gx = as_matrix(Gx_, c.nx, node.size), Gu = as_matrix(Gu_, c.nu, node.size);
  MatrixMap E = as_matrix(E_, c.nx, node.size), S = as_matrix(S_, node.size, node.size);
  for (MatrixMap* M : {&Gx, &Gu, &E, &S}) M->setZero();
  const auto part_of = [&](int coupling, bool is_w) {
    for (const CouplingPart& part : node.parts)
      if (part.coupling == coupling && part.is_w == is_w) return part.at;
    return 0;  // the part has size zero
  };
  for (const Member& m : c.members) {
    const Group& g = problem.knots[k].groups[m.group];
    const Piece& u = m.v.front();
    Index w = u.size, row = 0;
    for (int b : g.couplings) {
      const Coupling& coupling = problem.knots[k].couplings[b];
      const int yw = part_of(b, true), ymu = part_of(b, false);
      Gx.block(m.x, yw, m.nx, coupling.size) += g.S.middleCols(w, coupling.size);
      Gx.block(m.x, ymu, m.nx, coupling.rows) += g.C.middleRows(row, coupling.rows).transpose();
      Gu.block(u.to, yw, u.size, coupling.size) += g.R.block(0, w, u.size, coupling.size);
      Gu.block(u.to, ymu, u.size, coupling.rows) += g.D.block(row, 0, coupling.rows, u.size).transpose();
      if (!last) E.block(m.x, yw, m.nx, coupling.size) += g.B.middleCols(w, coupling.size);
      Index other = u.size;
      for (int a : g.couplings) {
        const int size = problem.knots[k].couplings[a].size, ya = part_of(a, true);
        S.block(ya, yw, size, coupling.size) += g.R.block(other, w, size, coupling.size);
        S.block(ymu, ya, coupling.rows, size) += g.D.block(row, other, coupling.rows, size);
        S.block(ya, ymu, size, coupling.rows) += g.D.block(row, other, coupling.rows, size).transpose();
        other += size;
      }
      w += coupling.size;
      row += coupling.rows;
    }
  }
}

// Returns the cluster's symplectic structure in knot k if every knot has such a structure, otherwise null.
const SymplecticStructure* CouplingSchur::steps(const Problem& problem, int cluster, int k) const {
  return by_steps_ ? riccati_.steps(problem, k, graph_.nodes[cluster][k].cluster) : nullptr;
}

// Computes F, pi, theta, S_kk of knot k and W of knot k + 1. With `steps`, F = [J 0; 0 0] + [G; 1] F_z is stored as its
// lower half F_z.
void CouplingSchur::respond_at(const Problem& problem, int cluster, int k) {
  const CouplingNode& node = graph_.nodes[cluster][k];
  const Cluster& c = riccati_.plan()[k][node.cluster];
  const Riccati::Policy& policy = riccati_.policy(k, node.cluster);
  const bool last = k == problem.horizon();
  const Index n = c.nx, y = node.size, ny = by_steps_ ? n / 2 : 0, nz = n - ny;
  const SymplecticStructure* steps = this->steps(problem, cluster, k);
  MatrixMap W = as_matrix(W_, n, n), F = as_matrix(F_[k], nz, n), FW = as_matrix(FW_, nz, n);
  MatrixMap B = as_matrix(U_, nz, c.nu);
  if (!last) {
    B.setZero();
    F.setZero();
    for (const Member& m : c.members) {
      const Group& g = problem.knots[k].groups[m.group];
      const Piece& u = m.v.front();
      B.block(m.x, u.to, m.nx - ny, u.size) = g.B.block(ny, 0, m.nx - ny, u.size);
      F.block(m.x, m.x, m.nx - ny, m.nx) = g.A.bottomRows(m.nx - ny);
      add_AB(F.middleRows(m.x, m.nx - ny), 1, g.B.block(ny, 0, m.nx - ny, u.size), policy.K.middleRows(u.to, u.size));
    }
    FW.setZero();
    add_AB(FW, 1, F, W);
  }

  if (y > 0) {
    add_terms_of_y(problem, k, node);
    MatrixMap Gx = as_matrix(Gx_, n, y), Gu = as_matrix(Gu_, c.nu, y), E = as_matrix(E_, n, y);
    MatrixMap PE = as_matrix(PE_, n, y), Y = as_matrix(Y_, c.nu, y), S = as_matrix(S_, y, y);
    MatrixMap pi = as_matrix(pi_[k], n, y), theta = as_matrix(theta_[k], n, y);
    MatrixMap GPE = as_matrix(Z_, nz, y);  // [G; 1]^T P+ E
    pi = Gx;
    if (!last) {
      const Eigen::Ref<const MatrixXd> P = riccati_.next_value(problem, k, node.cluster);
      PE.setZero();
      add_AB(PE, 1, P, E);
      GPE = PE.bottomRows(nz);
      if (steps) add_DtX(GPE, 1, steps->G, PE.topRows(ny));
      add_AtB(pi, 1, policy.K, Gu);  // pi = Gx + K^T Gu + F^T P+ E
      add_AtB(pi, 1, F, GPE);
      if (steps) add_DtX(pi.topRows(ny), 1, steps->J, PE.topRows(ny));
      Y = Gu;
      add_AtB(Y, 1, B, GPE);  // Y = g = Gu + B^T P+ E
      solve_L(policy.L, Y);
      add_lower_AtB(S, 1, E, PE);
      add_lower_AtB(S, -1, Y, Y);  // S -= g^T Qvv^-1 g
      solve_Lt(policy.L, Y);
      theta.bottomRows(nz) = E.bottomRows(nz);  // theta_z, the lower half of theta
      add_AB(theta.bottomRows(nz), -1, B, Y);
      add_AB(theta.bottomRows(nz), -1, FW, pi);
    }
    MatrixMap& Wpi = PE;
    Wpi.setZero();
    add_AB(Wpi, 1, W, pi);
    if (steps) {  // the upper half is stored as theta_y - G theta_z
      add_DX(theta.topRows(ny), 0, steps->J, Wpi.topRows(ny));
      theta.topRows(ny) *= -1;
    }
    add_lower_AtB(S, -1, pi, Wpi);
    copy_lower_to_upper(S);
    for (std::size_t a = 0; a < node.parts.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const CouplingPart &i = node.parts[a], &j = node.parts[b];
        schur_.add(i.vertex, i.offset, j.vertex, j.offset, S.block(i.at, j.at, i.size, j.size));
      }
  }

  if (last) return;
  solve_Lt_right(policy.L, B);
  MatrixMap Wzz = as_matrix(V_, nz, nz);
  Wzz.setZero();  // W+ = F W F^T + B Qvv^-1 B^T
  add_lower_ABt(Wzz, 1, FW, F);
  add_lower_ABt(Wzz, 1, B, B);
  copy_lower_to_upper(Wzz);
  if (steps) {
    // W+_zy = F_z W_y J^T + W+_zz G^T,    W+_yy = (J W_yy + G F_z W_y) J^T + W+_yz G^T
    auto Wyy = W.topLeftCorner(ny, ny), Wzy = W.bottomLeftCorner(nz, ny), Wyz = W.topRightCorner(ny, nz);
    MatrixMap JW = as_matrix(Z_, ny, ny);
    add_DX(JW, 0, steps->J, Wyy);
    add_DX(JW, 1, steps->G, FW.leftCols(ny));
    add_XDt(Wzy, 0, FW.leftCols(ny), steps->J);
    add_XDt(Wzy, 1, Wzz, steps->G);
    Wyz = Wzy.transpose();
    add_XDt(Wyy, 0, JW, steps->J);
    add_XDt(Wyy, 1, Wyz, steps->G);
  }
  W.bottomRightCorner(nz, nz) = Wzz;
  // From here on F_zz contains F_zy G_(k-1) + F_zz, which `sweep` uses, where G_(k-1) is the G of knot k - 1.
  if (steps && k > 0) add_XD(F.rightCols(nz), 1, F.leftCols(ny), this->steps(problem, cluster, k - 1)->G);
  if (c.next_in_order) return;
  const Cluster& next = riccati_.plan()[k + 1][graph_.nodes[cluster][k + 1].cluster];
  reorder_rows(problem, c, next, W, FW);
  W = FW.transpose();
  reorder_rows(problem, c, next, W, FW);
  W = FW;
}

// Computes S_jl for all j < l and the y_l of one vertex. The last columns contain V = F_(j+1)^T ... F_(l-1)^T pi_l for
// all l > j, with states ordered as in knot j + 1. V has the halves V_y, V_z. With steps, V_y and Z = G_j^T V_y + V_z
// are stored:
//
//   theta^T V = (theta_y - G_j theta_z)^T V_y + theta_z^T Z
//   [V_y; Z] <- [J^T V_y; G_(j-1)^T J^T V_y] + [F_zy  F_zy G_(j-1) + F_zz]^T Z       F_j^T V in the order of knot j
void CouplingSchur::sweep(const Problem& problem, int cluster, int vertex) {
  const int size = graph_.vertices[vertex].size;
  int first = size;
  std::vector<double>*Z = &Z_, *scratch = &Z_next_;
  for (int k = problem.horizon(); k >= 0; --k) {
    const CouplingNode& node = graph_.nodes[cluster][k];
    const Cluster& c = riccati_.plan()[k][node.cluster];
    const Index n = c.nx, ny = by_steps_ ? n / 2 : 0, nz = n - ny;
    const SymplecticStructure* before = k > 0 ? steps(problem, cluster, k - 1) : nullptr;
    MatrixMap Vy = as_matrix(V_, ny, size);
    if (first < size) {
      if (!c.next_in_order) {
        const Cluster& next = riccati_.plan()[k + 1][graph_.nodes[cluster][k + 1].cluster];
        reorder_rows(problem, next, c, as_matrix(*Z, n, size), as_matrix(*scratch, n, size));
        std::swap(Z, scratch);
      }
      auto Vy_later = Vy.rightCols(size - first);
      const auto later = as_matrix(*Z, nz, size).rightCols(size - first);
      if (node.size > 0) {
        MatrixMap S = as_matrix(S_, node.size, size - first), theta = as_matrix(theta_[k], n, node.size);
        S.setZero();
        add_AtB(S, 1, theta.topRows(ny), Vy_later);
        add_AtB(S, 1, theta.bottomRows(nz), later);
        for (const CouplingPart& i : node.parts)
          schur_.add(i.vertex, i.offset, vertex, first, S.middleRows(i.at, i.size));
      }
      if (k > 0) {
        const MatrixMap F = as_matrix(F_[k], nz, n);
        auto Z_k = as_matrix(*scratch, nz, size).rightCols(size - first);
        if (before) {
          multiply_Dt(steps(problem, cluster, k)->J, Vy_later);
          add_DtX(Z_k, 0, before->G, Vy_later);
          add_AtB(Vy_later, 1, F.leftCols(ny), later);
        } else {
          Z_k.setZero();
        }
        add_AtB(Z_k, 1, F.rightCols(nz), later);
        std::swap(Z, scratch);
      }
    }
    for (const CouplingPart& part : node.parts)
      if (k > 0 && part.vertex == vertex) {
        const auto pi = as_matrix(pi_[k], n, node.size).middleCols(part.at, part.size);
        auto Z_new = as_matrix(*Z, nz, size).middleCols(part.offset, part.size);
        Vy.middleCols(part.offset, part.size) = pi.topRows(ny);
        Z_new = pi.bottomRows(nz);
        if (before) add_DtX(Z_new, 1, before->G, pi.topRows(ny));
        first = std::min(first, part.offset);
      }
  }
}

void CouplingSchur::respond(const Problem& problem, int cluster) {
  if (graph_.of_cluster[cluster].empty()) return;
  by_steps_ = problem.horizon() > 0;
  for (int k = 0; k < problem.horizon() && by_steps_; ++k)
    by_steps_ = riccati_.steps(problem, k, graph_.nodes[cluster][k].cluster) != nullptr;
  const Cluster& c = riccati_.plan()[0][graph_.nodes[cluster][0].cluster];
  as_matrix(W_, c.nx, c.nx).setZero();
  for (int k = 0; k <= problem.horizon(); ++k) respond_at(problem, cluster, k);
  for (const int vertex : graph_.of_cluster[cluster]) sweep(problem, cluster, vertex);
}

}  // namespace manycontact::lq
