// The vectors' part of the recursion: k and p backward, x, v, lambda, mu forward.

#include "dense.hpp"
#include "manycontact/lq/riccati.hpp"

namespace manycontact::lq {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

void gather(const VectorXd& all, const std::vector<int>& start, const std::vector<int>& blocks,
            const std::vector<int>& to, const std::vector<int>& size, VectorXd& out) {
  for (std::size_t i = 0; i < blocks.size(); ++i)
    out.segment(to[i], size[blocks[i]]) = all.segment(start[blocks[i]], size[blocks[i]]);
}

void scatter(const VectorXd& in, const std::vector<int>& start, const std::vector<int>& blocks,
             const std::vector<int>& from, const std::vector<int>& size, VectorXd& all) {
  for (std::size_t i = 0; i < blocks.size(); ++i)
    all.segment(start[blocks[i]], size[blocks[i]]) = in.segment(from[i], size[blocks[i]]);
}

}  // namespace

// k and p of knot k, from t = p+ + P+ f.
void Riccati::backward(const Problem& problem, const Point& h, int k) {
  const bool last = k == problem.horizon();
  if (!last)
    for (std::size_t d = 0; d < plan_[k + 1].size(); ++d) {
      const Cluster& next = plan_[k + 1][d];
      gather(h.lambda[k + 1], layout_.x, next.blocks, next.x_start, problem.nx, f_);
      x_.head(next.nx) = p_[k + 1][d];
      add_Ax(x_.head(next.nx), 1, policies_[k + 1][d].P, f_.head(next.nx));
      scatter(x_, layout_.x, next.blocks, next.x_start, problem.nx, t_);
    }
  for (std::size_t index = 0; index < plan_[k].size(); ++index) {
    const Cluster& c = plan_[k][index];
    const Policy& policy = policies_[k][index];
    VectorXd& p = p_[k][index];
    gather(h.x[k], layout_.x, c.blocks, c.x_start, problem.nx, p);
    v_.setZero();
    if (!last) gather(h.u[k], layout_.u, c.blocks, c.u_start, problem.nu, v_);
    for (std::size_t b = 0; b < c.couplings.size(); ++b) {
      const Coupling& coupling = problem.knots[k].couplings[c.couplings[b]];
      v_.segment(c.w_start[b], coupling.size) = h.w[k].segment(layout_.w[k][c.couplings[b]], coupling.size);
      v_.segment(c.nv + c.row_start[b], coupling.rows) =
          h.mu[k].segment(layout_.rows[k][c.couplings[b]], coupling.rows);
    }
    if (!last) {
      gather(t_, layout_.x, c.blocks, c.x_start, problem.nx, x_);
      for (const Member& m : c.members) {
        const Group& g = problem.knots[k].groups[m.group];
        const auto t = x_.segment(m.x, m.nx);
        add_Atx(p.segment(m.x, m.nx), 1, g.A, t);  // qx
        for (const Piece& a : m.v)                 // qv
          add_Atx(v_.segment(a.to, a.size), 1, g.B.middleCols(a.from, a.size), t);
      }
    }
    const auto qv = v_.head(c.nv + c.rows);
    add_Atx(p, 1, policy.K, qv);  // p = qx + K^T qv + K'^T d
    VectorXd& k_now = k_[k][index];
    if (c.rows == 0) {
      k_now = -qv;
      solve_L(policy.L, k_now);
      solve_Lt(policy.L, k_now);
    } else {
      for (Index i = 0; i < qv.size(); ++i) k_now[policy.lu.permutationP().indices()[i]] = -qv[i];
      policy.lu.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(k_now);
      policy.lu.matrixLU().triangularView<Eigen::Upper>().solveInPlace(k_now);
    }
  }
}

void Riccati::forward(const Problem& problem, const Point& h, int k, Point& z) {
  const bool last = k == problem.horizon();
  if (!last) z.x[k + 1] = h.lambda[k + 1];
  for (std::size_t index = 0; index < plan_[k].size(); ++index) {
    const Cluster& c = plan_[k][index];
    const Policy& policy = policies_[k][index];
    gather(z.x[k], layout_.x, c.blocks, c.x_start, problem.nx, x_);
    const auto x = x_.head(c.nx);
    auto v = v_.head(c.nv + c.rows);
    v = k_[k][index];
    add_Ax(v, 1, policy.K, x);
    f_.head(c.nx) = p_[k][index];
    add_Ax(f_.head(c.nx), 1, policy.P, x);
    scatter(f_, layout_.x, c.blocks, c.x_start, problem.nx, z.lambda[k]);
    if (!last) scatter(v_, layout_.u, c.blocks, c.u_start, problem.nu, z.u[k]);
    for (std::size_t b = 0; b < c.couplings.size(); ++b) {
      const Coupling& coupling = problem.knots[k].couplings[c.couplings[b]];
      z.w[k].segment(layout_.w[k][c.couplings[b]], coupling.size) = v_.segment(c.w_start[b], coupling.size);
      z.mu[k].segment(layout_.rows[k][c.couplings[b]], coupling.rows) =
          v_.segment(c.nv + c.row_start[b], coupling.rows);
    }
    if (last) continue;
    for (const Member& m : c.members) {  // x+ = A x + B v + f
      const Group& g = problem.knots[k].groups[m.group];
      auto next = f_.head(m.nx);
      next.setZero();
      add_Ax(next, 1, g.A, x.segment(m.x, m.nx));
      for (const Piece& a : m.v) add_Ax(next, 1, g.B.middleCols(a.from, a.size), v_.segment(a.to, a.size));
      Index at = 0;
      for (int i : g.blocks) {
        z.x[k + 1].segment(layout_.x[i], problem.nx[i]) += next.segment(at, problem.nx[i]);
        at += problem.nx[i];
      }
    }
  }
}

void Riccati::pass(const Problem& problem, const Point& h, Point& z) {
  for (int k = problem.horizon(); k >= 0; --k) backward(problem, h, k);
  z.x[0] = h.lambda[0];
  for (int k = 0; k <= problem.horizon(); ++k) forward(problem, h, k, z);
}

void Riccati::do_solve(const Problem& problem, const Point& h, Point& z, bool first) {
  pass(problem, h, z);
  for (std::size_t k = 0; k < plan_.size(); ++k)
    for (std::size_t c = 0; c < plan_[k].size(); ++c) {
      Policy& policy = policies_[k][c];
      if (first) {
        policy.k = k_[k][c];
        policy.p = p_[k][c];
      } else {
        policy.k += k_[k][c];
        policy.p += p_[k][c];
      }
    }
}

}  // namespace manycontact::lq
