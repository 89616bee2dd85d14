#include "manycontact/lq/riccati.hpp"

#include <algorithm>
#include <cmath>

#include "dense.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::lq {

namespace {

bool finite(const Eigen::Ref<const MatrixXd>& M) { return std::isfinite(M.sum()); }

constexpr double kConvexWhereFeasible = 1e6;  // weight of |D v|^2 in the test of convexity, in units of |Qvv| / |D|^2

constexpr double kSingularPivot = 1e-14;  // smallest accepted pivot of the LU, relative to the largest pivot

}  // namespace

const char* Riccati::name() const {
  constexpr const char* names[] = {"dense Riccati", "Riccati by islands", "Riccati without couplings"};
  return names[static_cast<int>(join_)];
}

const SymplecticStructure* Riccati::steps(const Problem& problem, int k, int index) const {
  const Cluster& c = plan_[k][index];
  const std::optional<SymplecticStructure>& steps = problem.knots[k].groups[c.members.front().group].steps;
  return join_ != Join::kAll && k < problem.horizon() && c.members.size() == 1 && steps ? &*steps : nullptr;
}

void Riccati::do_analyse(const Problem& problem) {
  plan_ = make_plan(problem, join_);
  flops_ = riccati_flops(problem, plan_);
  policies_.assign(plan_.size(), {});
  Index n = 0, e = 0;
  for (std::size_t k = 0; k < plan_.size(); ++k)
    for (const Cluster& c : plan_[k]) {
      const Index rows = c.nv + c.rows;
      policies_[k].push_back({MatrixXd::Zero(rows, c.nx), VectorXd::Zero(rows), MatrixXd::Zero(c.nx, c.nx),
                              VectorXd::Zero(c.nx), MatrixXd::Zero(rows, rows),
                              Eigen::PartialPivLU<MatrixXd>(c.rows ? rows : 0)});
      n = std::max<Index>(n, c.nx);
      step_.lay_out(c.nv, c.nx);
      e = std::max(e, rows);
    }
  k_.assign(plan_.size(), {});
  p_.assign(plan_.size(), {});
  for (std::size_t k = 0; k < plan_.size(); ++k)
    for (const Policy& policy : policies_[k]) {
      k_[k].push_back(policy.k);
      p_[k].push_back(policy.p);
    }
  x_of_block_.assign(problem.blocks(), 0);
  next_.resize(n * n);
  with_rows_.resize(n * e);
  t_.resize(layout_.x.back());
  x_.resize(n);
  f_.resize(n);
  v_.resize(e);
}

Eigen::Ref<const MatrixXd> Riccati::next_value(const Problem& problem, int k, int index) {
  const Cluster& c = plan_[k][index];
  if (c.next_in_order) return policies_[k + 1][c.next[0]].P;
  MatrixMap P = as_matrix(next_, c.nx, c.nx);
  P.setZero();
  for (std::size_t i = 0; i < c.blocks.size(); ++i) x_of_block_[c.blocks[i]] = c.x_start[i];
  for (int d : c.next) {
    const Cluster& next = plan_[k + 1][d];
    const MatrixXd& stored = policies_[k + 1][d].P;
    for (std::size_t i = 0; i < next.blocks.size(); ++i)
      for (std::size_t j = 0; j < next.blocks.size(); ++j) {
        const int bi = next.blocks[i], bj = next.blocks[j];
        P.block(x_of_block_[bi], x_of_block_[bj], problem.nx[bi], problem.nx[bj]) =
            stored.block(next.x_start[i], next.x_start[j], problem.nx[bi], problem.nx[bj]);
      }
  }
  return P;
}

void Riccati::expand(const Problem& problem, int k, int index, const Regularisation& reg) {
  const Cluster& c = plan_[k][index];
  step_.lay_out(c.nv, c.nx);
  if (k == problem.horizon())
    step_.set_zero();
  else
    expand_next_value(problem, k, index);
  auto Qxx = step_.Qxx(), Qxv = step_.Qxv(), Qvv = step_.Qvv();
  for (const Member& m : c.members) {
    const Group& g = problem.knots[k].groups[m.group];
    Qxx.block(m.x, m.x, m.nx, m.nx).triangularView<Eigen::Lower>() += g.Q;
    for (const Piece& a : m.v) {
      Qxv.block(m.x, a.to, m.nx, a.size) += g.S.middleCols(a.from, a.size);
      for (const Piece& b : m.v) Qvv.block(b.to, a.to, b.size, a.size) += g.R.block(b.from, a.from, b.size, a.size);
    }
  }
  Qxx.diagonal().array() += reg.x;
  if (c.nu > 0) Qvv.diagonal().head(c.nu).array() += reg.u;
}

void Riccati::expand_next_value(const Problem& problem, int k, int index) {
  const Cluster& c = plan_[k][index];
  const SymplecticStructure* known = steps(problem, k, index);
  for (const Member& m : c.members) {
    const Group& g = problem.knots[k].groups[m.group];
    const Index rows = known ? m.nx / 2 : m.nx;
    step_.set_A(g.A.bottomRows(rows), m.x, m.x);
    for (const Piece& a : m.v) step_.set_B(g.B.bottomRows(rows).middleCols(a.from, a.size), m.x, a.to);
  }
  if (known)
    step_.multiply(next_value(problem, k, index), *known);
  else
    step_.multiply(next_value(problem, k, index), c.members);
}

// Computes K and P of a cluster without couplings.
Status Riccati::eliminate(const Problem& problem, int k, int index, const Regularisation& reg) {
  const Cluster& c = plan_[k][index];
  Policy& policy = policies_[k][index];
  copy_lower_to_upper(step_.Qvv());
  if (c.rows == 0) {
    if (!step_.eliminate(policy.L, tolerance::kPivotLeft))
      return finite(step_.Qvv()) ? Status::kNotConvex : Status::kNotFinite;
    policy.K = -step_.Kt().transpose();
    step_.value(policy.P);
  } else {
    policy.P = step_.Qxx();
    const Status status = eliminate_with_rows(problem, k, index, reg);
    if (status != Status::kOk) return status;
    copy_lower_to_upper(policy.P);
  }
  return finite(policy.P) ? Status::kOk : Status::kNotFinite;
}

// Computes K and P of a cluster with couplings. Cholesky of Qvv + weight D^T D tests whether Qvv > 0 on D v = 0.
Status Riccati::eliminate_with_rows(const Problem& problem, int k, int index, const Regularisation& reg) {
  const Cluster& c = plan_[k][index];
  Policy& policy = policies_[k][index];
  const Index size = c.nv + c.rows;
  auto Qxv = step_.Qxv(), Qvv = step_.Qvv();
  MatrixXd& right = policy.K;  // [Qxv^T; C]
  right.topRows(c.nv) = Qxv.transpose();
  right.bottomRows(c.rows).setZero();
  MatrixXd& M = policy.L;
  M.setZero(size, size);
  M.topLeftCorner(c.nv, c.nv) = Qvv;
  for (const Member& m : c.members) {
    const Group& g = problem.knots[k].groups[m.group];
    for (const Piece& row : m.rows) {
      right.block(c.nv + row.to, m.x, row.size, m.nx) += g.C.middleRows(row.from, row.size);
      for (const Piece& a : m.v) {
        const auto D = g.D.block(row.from, a.from, row.size, a.size);
        M.block(c.nv + row.to, a.to, row.size, a.size) += D;
        M.block(a.to, c.nv + row.to, a.size, row.size) += D.transpose();
      }
    }
  }
  M.diagonal().tail(c.rows).array() -= reg.rows;
  if (!finite(M)) return Status::kNotFinite;
  const auto D = M.bottomLeftCorner(c.rows, c.nv);
  const double of_Q = Qvv.cwiseAbs().maxCoeff(), of_D = D.cwiseAbs2().maxCoeff();
  const double weight = of_Q > 0 && of_D > 0 ? kConvexWhereFeasible * of_Q / of_D : 1;
  add_lower_AtB(Qvv, reg.rows > 0 ? 1 / reg.rows : weight, D, D);

  policy.lu.compute(M);
  const auto pivots = policy.lu.matrixLU().diagonal().cwiseAbs();
  if (!(pivots.minCoeff() > kSingularPivot * pivots.maxCoeff())) return Status::kSingular;
  if (!cholesky(Qvv, 0)) return Status::kNotConvex;

  MatrixMap both = as_matrix(with_rows_, c.nx, size);
  both = right.transpose();
  for (Index i = 0; i < size; ++i) right.row(policy.lu.permutationP().indices()[i]) = -both.col(i).transpose();
  policy.lu.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(right);
  policy.lu.matrixLU().triangularView<Eigen::Upper>().solveInPlace(right);
  add_lower_AB(policy.P, 1, both, right);  // P = Qxx + Qxv K + C^T K' (riccati.hpp)
  return Status::kOk;
}

Outcome Riccati::do_factorize(const Problem& problem, const Regularisation& reg) {
  for (int k = problem.horizon(); k >= 0; --k)
    for (int c = 0; c < static_cast<int>(plan_[k].size()); ++c) {
      expand(problem, k, c, reg);
      const Status status = eliminate(problem, k, c, reg);
      if (status != Status::kOk) return {status, k};
    }
  return {};
}

// ---- recursions of the vectors: k and p from k = T to 0, then x, v, lambda, mu from k = 0 to T

namespace {

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

// Computes the clusters' feed-forward terms and the gradients p of their value functions in knot k, from t = p+ + P+ f.
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
        add_Atx(p.segment(m.x, m.nx), 1, g.A, t);  // qx += A^T t
        for (const Piece& a : m.v)                 // qv += B^T t
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
    for (const Member& m : c.members) {  // next knot's x+ = A x + B v + f
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
