#include "resisting_springs.hpp"

namespace manycontact::internal {

namespace {

// Returns whether a row is part of the factorization. A row along a spring always is, a row across it only with `all`.
bool takes_part(const ResistingSprings::Row& row, bool all) { return all || !is_across(row); }

// Factorizes a system of few rows. Rows that are not part of the factorization are decoupled.
void factorize_few(bool all, ResistingSprings& s) {
  s.with_D = s.C;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!takes_part(s.rows[i], all)) s.with_D.row(k).setZero(), s.with_D.col(k).setZero();
    s.with_D(k, k) += 1 / s.rows[i].D;
  }
  s.pivoted_factor.compute(s.with_D);
}

void factorize_dense(bool all, ResistingSprings& s) {
  s.used.clear();
  for (std::size_t i = 0; i < s.rows.size(); ++i)
    if (takes_part(s.rows[i], all) && s.rows[i].D != kIdle) s.used.push_back(static_cast<int>(i));
  const auto n = static_cast<Eigen::Index>(s.used.size());
  const auto row = [&](Eigen::Index k) { return s.used[k]; };
  s.with_D.resize(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) s.with_D(i, j) = s.C(row(i), row(j));
    s.with_D(j, j) += 1 / s.rows[row(j)].D;
  }
  s.factor.compute(s.with_D);
  if (s.factor.info() != Eigen::Success) s.pivoted_factor.compute(s.with_D);
}

void solve_dense(ResistingSprings& s, Eigen::VectorXd& x) {
  const auto n = static_cast<Eigen::Index>(s.used.size());
  s.of_used.resize(n);
  for (Eigen::Index k = 0; k < n; ++k) s.of_used[k] = x[s.used[k]];
  s.factor.info() == Eigen::Success ? (void)s.factor.solveInPlace(s.of_used)
                                    : (void)s.pivoted_factor.solveInPlace(s.of_used);
  x.setZero();
  for (Eigen::Index k = 0; k < n; ++k) x[s.used[k]] = s.of_used[k];
}

bool factorize_sparse(bool all, ResistingSprings& s) {
  const auto n = static_cast<Eigen::Index>(s.rows.size());
  const auto has = [&](Eigen::Index i) { return takes_part(s.rows[i], all); };
  s.own_entries.clear();
  for (const auto& e : s.entries)
    if (has(e.row()) && has(e.col())) s.own_entries.push_back(e);
  for (std::size_t i = 0; i < s.rows.size(); ++i)
    s.own_entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 1 / s.rows[i].D);
  s.S.resize(n, n);
  s.S.setFromTriplets(s.own_entries.begin(), s.own_entries.end());
  s.sparse_factor.compute(s.S);
  return s.sparse_factor.info() == Eigen::Success;
}

}  // namespace

bool factorize_rows(bool all, ResistingSprings& s) {
  if (!s.is_dense) return factorize_sparse(all, s);
  s.rows.size() <= kFewRows ? factorize_few(all, s) : factorize_dense(all, s);
  return true;
}

void solve_rows(ResistingSprings& s, Eigen::VectorXd& x) {
  if (s.rows.size() <= kFewRows)
    s.pivoted_factor.solveInPlace(x);
  else if (s.is_dense)
    solve_dense(s, x);
  else
    x = s.sparse_factor.solve(x).eval();
}

}  // namespace manycontact::internal
