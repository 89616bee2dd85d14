#include "manycontact/lq/riccati.hpp"

#include <algorithm>
#include <cmath>

#include "dense.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::lq {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using MatrixMap = Eigen::Map<MatrixXd>;

namespace {

// The first rows x cols numbers of a scratch.
MatrixMap as_matrix(std::vector<double>& scratch, Index rows, Index cols) { return {scratch.data(), rows, cols}; }

// NaN and infinite entries show in the sum.
bool finite(const Eigen::Ref<const MatrixXd>& M) { return std::isfinite(M.sum()); }

// Weight of |D v|^2 that shows whether Qvv is positive definite where D v = 0, beside Qvv's and D's sizes.
constexpr double kConvexWhereFeasible = 1e6;

// Pivots of the LU beside the largest one, whatever their units: less is singular to working precision.
constexpr double kSingularPivot = 1e-14;

}  // namespace

const char* Riccati::name() const {
  switch (join_) {
    case Join::kAll:
      return "dense Riccati";
    case Join::kIslands:
      return "Riccati by islands";
    case Join::kNoBonds:
      return "Riccati without bonds";
  }
  return "";
}

const Steps* Riccati::steps(const Problem& problem, int k, int index) const {
  const Cluster& c = plan_[k][index];
  const std::optional<Steps>& steps = problem.knots[k].groups[c.members.front().group].steps;
  return join_ != Join::kAll && k < problem.horizon() && c.members.size() == 1 && steps ? &*steps : nullptr;
}

const Riccati::Policy& Riccati::policy(int knot, int cluster) const { return policies_[knot][cluster]; }

void Riccati::do_analyse(const Problem& problem) {
  plan_ = make_plan(problem, join_);
  flops_ = riccati_flops(problem, plan_);
  policies_.assign(plan_.size(), {});
  Index n = 0, m = 0, e = 0;
  for (std::size_t k = 0; k < plan_.size(); ++k)
    for (const Cluster& c : plan_[k]) {
      const Index rows = c.nv + c.rows;
      policies_[k].push_back({MatrixXd::Zero(rows, c.nx), VectorXd::Zero(rows), MatrixXd::Zero(c.nx, c.nx),
                              VectorXd::Zero(c.nx), MatrixXd::Zero(rows, rows),
                              Eigen::PartialPivLU<MatrixXd>(c.rows ? rows : 0)});
      n = std::max<Index>(n, c.nx);
      m = std::max<Index>(m, c.nv);
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
  PA_.resize(n * n);
  PB_.resize(n * m);
  PG_.resize(n * n);
  halves_.resize(n * n);
  Qxv_.resize(n * e);
  Qvv_.resize(e * e);
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

// Qxx (lower triangle, in the policy's P), Qxv, Qvv (lower triangle) of cluster `index`.
void Riccati::expand(const Problem& problem, int k, int index, const Regularisation& reg) {
  const Cluster& c = plan_[k][index];
  MatrixXd& Qxx = policies_[k][index].P;
  MatrixMap Qxv = as_matrix(Qxv_, c.nx, c.nv), Qvv = as_matrix(Qvv_, c.nv, c.nv);
  Qxx.setZero();
  Qxv.setZero();
  Qvv.setZero();
  for (const Member& m : c.members) {
    const Group& g = problem.knots[k].groups[m.group];
    Qxx.block(m.x, m.x, m.nx, m.nx) = g.Q;
    for (const Piece& a : m.v) {
      Qxv.block(m.x, a.to, m.nx, a.size) += g.S.middleCols(a.from, a.size);
      for (const Piece& b : m.v) Qvv.block(b.to, a.to, b.size, a.size) += g.R.block(b.from, a.from, b.size, a.size);
    }
  }
  Qxx.diagonal().array() += reg.x;
  if (c.nu > 0) Qvv.diagonal().head(c.nu).array() += reg.u;
  if (k == problem.horizon()) return;

  if (const Steps* known = steps(problem, k, index))
    add_next_value_by_steps(problem, k, index, *known);
  else
    add_next_value(problem, k, index);
}

// A^T P+ A, A^T P+ B, B^T P+ B
void Riccati::add_next_value(const Problem& problem, int k, int index) {
  const Cluster& c = plan_[k][index];
  MatrixXd& Qxx = policies_[k][index].P;
  MatrixMap Qxv = as_matrix(Qxv_, c.nx, c.nv), Qvv = as_matrix(Qvv_, c.nv, c.nv);
  const Eigen::Ref<const MatrixXd> P = next_value(problem, k, index);
  MatrixMap PA = as_matrix(PA_, c.nx, c.nx), PB = as_matrix(PB_, c.nx, c.nv);
  PA.setZero();
  PB.setZero();
  for (const Member& m : c.members) {
    const Group& g = problem.knots[k].groups[m.group];
    add_AB(PA.middleCols(m.x, m.nx), 1, P.middleCols(m.x, m.nx), g.A);  // P+ A
    for (const Piece& a : m.v)                                          // P+ B
      add_AB(PB.middleCols(a.to, a.size), 1, P.middleCols(m.x, m.nx), g.B.middleCols(a.from, a.size));
  }
  for (const Member& m : c.members) {
    const Group& g = problem.knots[k].groups[m.group];
    add_AtB(Qxx.block(m.x, 0, m.nx, m.x), 1, g.A, PA.block(m.x, 0, m.nx, m.x));  // A^T P+ A
    add_lower_AtB(Qxx.block(m.x, m.x, m.nx, m.nx), 1, g.A, PA.block(m.x, m.x, m.nx, m.nx));
    add_AtB(Qxv.middleRows(m.x, m.nx), 1, g.A, PB.middleRows(m.x, m.nx));  // A^T P+ B
    for (const Piece& a : m.v) {                                           // B^T P+ B
      const auto B = g.B.middleCols(a.from, a.size);
      add_AtB(Qvv.block(a.to, 0, a.size, a.to), 1, B, PB.block(m.x, 0, m.nx, a.to));
      add_lower_AtB(Qvv.block(a.to, a.to, a.size, a.size), 1, B, PB.block(m.x, a.to, m.nx, a.size));
    }
  }
}

// The same with A = [J 0; 0 0] + [G; 1] A_z, B = [G; 1] B_z:  with W = [G; 1]^T P+ [G; 1], Y = [G; 1]^T P+ [J; 0] and
// E = [1 0],
//
//     A^T P+ A = A_z^T (W A_z + Y E) + E^T Y^T A_z + E^T J^T P+_yy J E
//     A^T P+ B = A_z^T W B_z + E^T Y^T B_z        B^T P+ B = B_z^T W B_z
void Riccati::add_next_value_by_steps(const Problem& problem, int k, int index, const Steps& steps) {
  const Cluster& c = plan_[k][index];
  const Member& m = c.members.front();
  const Group& g = problem.knots[k].groups[m.group];
  const Index n = c.nx, half = n / 2;
  MatrixXd& Qxx = policies_[k][index].P;
  MatrixMap Qxv = as_matrix(Qxv_, n, c.nv), Qvv = as_matrix(Qvv_, c.nv, c.nv);
  const Eigen::Ref<const MatrixXd> P = next_value(problem, k, index);
  const auto square = [&](Index i) { return MatrixMap(halves_.data() + i * half * half, half, half); };
  MatrixMap PG = as_matrix(PG_, n, half), W = square(0), Yt = square(1), PJ = square(2), JPJ = square(3);
  PG = P.rightCols(half);  // P+ [G; 1]
  add_XD(PG, 1, P.leftCols(half), steps.G);
  W = PG.bottomRows(half);
  add_DtX(W, 1, steps.G, PG.topRows(half));
  add_DtX(Yt, 0, steps.J, PG.topRows(half));
  add_XD(PJ, 0, P.topLeftCorner(half, half), steps.J);
  add_DtX(JPJ, 0, steps.J, PJ);

  const auto A = g.A.bottomRows(half);
  MatrixMap WA = as_matrix(PA_, half, n), WB = as_matrix(PB_, half, c.nv);
  WA.setZero();
  WB.setZero();
  add_AB(WA, 1, W, A);
  WA.leftCols(half) += Yt.transpose();
  add_lower_AtB(Qxx, 1, A, WA);
  add_AB(Qxx.topLeftCorner(half, half), 1, Yt, A.leftCols(half));
  Qxx.topLeftCorner(half, half) += JPJ;
  for (const Piece& a : m.v) add_AB(WB.middleCols(a.to, a.size), 1, W, g.B.block(half, a.from, half, a.size));
  add_AtB(Qxv, 1, A, WB);
  for (const Piece& a : m.v) {
    const auto B = g.B.block(half, a.from, half, a.size);
    add_AB(Qxv.block(0, a.to, half, a.size), 1, Yt, B);
    add_AtB(Qvv.block(a.to, 0, a.size, a.to), 1, B, WB.leftCols(a.to));
    add_lower_AtB(Qvv.block(a.to, a.to, a.size, a.size), 1, B, WB.middleCols(a.to, a.size));
  }
}

// K and P.
Status Riccati::eliminate(const Problem& problem, int k, int index, const Regularisation& reg) {
  const Cluster& c = plan_[k][index];
  Policy& policy = policies_[k][index];
  MatrixMap Qxv = as_matrix(Qxv_, c.nx, c.nv), Qvv = as_matrix(Qvv_, c.nv, c.nv);
  if (c.rows == 0) {
    policy.L = Qvv;
    if (!cholesky(policy.L, tolerance::kPivotLeft)) return finite(Qvv) ? Status::kNotConvex : Status::kNotFinite;
    policy.K = Qxv.transpose();
    solve_L(policy.L, policy.K);
    add_lower_AtB(policy.P, -1, policy.K, policy.K);  // P = Qxx - Qxv Qvv^-1 Qxv^T
    solve_Lt(policy.L, policy.K);
    policy.K = -policy.K;
  } else {
    copy_lower_to_upper(Qvv);
    const Status status = eliminate_with_rows(problem, k, index, reg);
    if (status != Status::kOk) return status;
  }
  copy_lower_to_upper(policy.P);
  return finite(policy.P) ? Status::kOk : Status::kNotFinite;
}

// The same with the bonds' equations. Qvv is positive definite where D v = 0 if Qvv + weight D^T D is.
Status Riccati::eliminate_with_rows(const Problem& problem, int k, int index, const Regularisation& reg) {
  const Cluster& c = plan_[k][index];
  Policy& policy = policies_[k][index];
  const Index size = c.nv + c.rows;
  MatrixMap Qxv = as_matrix(Qxv_, c.nx, c.nv), Qvv = as_matrix(Qvv_, c.nv, c.nv);
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

  MatrixMap both = as_matrix(Qxv_, c.nx, size);
  both = right.transpose();
  for (Index i = 0; i < size; ++i) right.row(policy.lu.permutationP().indices()[i]) = -both.col(i).transpose();
  policy.lu.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(right);
  policy.lu.matrixLU().triangularView<Eigen::Upper>().solveInPlace(right);
  add_lower_AB(policy.P, 1, both, right);  // P = Qxx + [Qxv C^T] [K; K']
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

}  // namespace manycontact::lq
