#include "manycontact/lq/riccati.hpp"

#include <algorithm>
#include <cmath>

#include "dense.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::lq {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// NaN and infinite entries show in the sum.
bool finite(const Eigen::Ref<const MatrixXd>& M) { return std::isfinite(M.sum()); }

// Weight of |D v|^2, relative to the sizes of Qvv and D, that shows whether Qvv is positive definite where D v = 0.
constexpr double kConvexWhereFeasible = 1e6;

// Smallest pivot of the LU relative to the largest one, whatever their units. Below it the matrix is singular to
// working precision.
constexpr double kSingularPivot = 1e-14;

}  // namespace

const char* Riccati::name() const {
  switch (join_) {
    case Join::kAll:
      return "dense Riccati";
    case Join::kIslands:
      return "Riccati by islands";
    case Join::kNoCouplings:
      return "Riccati without couplings";
  }
  return "";
}

const SymplecticStructure* Riccati::steps(const Problem& problem, int k, int index) const {
  const Cluster& c = plan_[k][index];
  const std::optional<SymplecticStructure>& steps = problem.knots[k].groups[c.members.front().group].steps;
  return join_ != Join::kAll && k < problem.horizon() && c.members.size() == 1 && steps ? &*steps : nullptr;
}

const Riccati::Policy& Riccati::policy(int knot, int cluster) const { return policies_[knot][cluster]; }

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

// Qxx, Qxv, Qvv of cluster `index`, in step_.
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

// F^T P+ F
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

// K and P.
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

// The same with the couplings' equations. Qvv is positive definite where D v = 0 if Qvv + weight D^T D is.
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
