#include "manycontact/rank/waiting_rows.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "manycontact/sparse/tolerances.hpp"
#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::rank {

namespace {

using Rows = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

// Calls use(row of K1, number of the waiting row, entry) for each entry of B. B^T: the waiting rows of J, i.e. those
// without a sound pivot in K's order; K1: K without them (file header of waiting_rows.hpp).
template <class Use>
void each_entry_of_B(const sparse::UpperCsc& K, const double* Kx, const double* D, const WaitingRows& w, Use&& use) {
  for (int k = 0; k < K.n; ++k)
    for (int p = K.p[k]; p < K.p[k + 1]; ++p) {
      const int i = K.i[p];
      if (w.place[k] >= 0 && std::isfinite(D[i])) use(i, w.place[k], Kx[p]);
      if (w.place[i] >= 0 && std::isfinite(D[k])) use(k, w.place[i], Kx[p]);
    }
}

// Computes w.Z = K1^-1 B with one refinement. B: the waiting rows' `width` columns; K1: K without them.
void solve_for_Z(const sparse::UpperCsc& K, const double* Kx, const double* D, int width, const SolvePanel& solve,
                 WaitingRows& w) {
  const std::size_t size = static_cast<std::size_t>(K.n) * width;
  w.same.resize(K.n);
  std::iota(w.same.begin(), w.same.end(), 0);
  w.B.assign(size, 0.0);
  each_entry_of_B(K, Kx, D, w,
                  [&](int i, int column, double value) { w.B[static_cast<std::size_t>(i) * width + column] = value; });
  w.Z = w.B;
  solve(w.Z.data(), width, width);
  sparse::residual_panel(K, Kx, w.same.data(), w.Z.data(), w.B.data(), width, width);
  solve(w.B.data(), width, width);
  for (std::size_t k = 0; k < size; ++k) w.Z[k] += w.B[k];
}

// Computes each waiting row's 1 / sqrt(terms of its pivot). The terms are l_j^2 |d_j| for rows j of K1 before it, J_i^2
// / M_ii for later rows i of M. Rows of J that are only rounding errors get 0, so that they do not join K1.
void take_scales(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx, std::span<const char> of_M,
                 const double* row_size, const double* Lx, const double* D, WaitingRows& w) {
  std::vector<double>&terms = w.scale, &largest = w.largest;
  terms.assign(w.rows.size(), 0.0);
  for (std::size_t c = 0; c < w.rows.size(); ++c)
    for (int p = s.Rp[w.rows[c]]; p < s.Rp[w.rows[c] + 1]; ++p)
      if (const double d = D[s.Rj[p]]; std::isfinite(d)) terms[c] += Lx[s.Rk[p]] * Lx[s.Rk[p]] * std::abs(d);
  largest.assign(w.rows.size(), 0.0);
  each_entry_of_B(K, Kx, D, w, [&](int i, int c, double value) {
    largest[c] = std::max(largest[c], std::abs(value));
    if (of_M[i] && i > w.rows[c]) terms[c] += value * value / Kx[K.p[i + 1] - 1];
  });
  for (std::size_t c = 0; c < w.rows.size(); ++c) {
    const bool is_plain = largest[c] > tolerance::kRank * row_size[w.rows[c]];
    terms[c] = is_plain && terms[c] > 0 ? 1 / std::sqrt(terms[c]) : 0;
  }
}

// Overwrites the lower half of A with its Cholesky factor, with diagonal pivoting. Exchanges the entries of `order`
// like the rows of A. Stops at the first pivot of at most kJoins, and returns the number of pivots before it.
int factorize_by_largest(Rows A, std::vector<int>& order) {
  const Eigen::Index n = A.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index largest = 0;
    const double pivot = A.diagonal().tail(n - k).maxCoeff(&largest);
    largest += k;
    if (!(pivot > tolerance::kJoins)) return static_cast<int>(k);
    if (largest != k) {
      for (Eigen::Index j = 0; j < k; ++j) std::swap(A(k, j), A(largest, j));
      for (Eigen::Index j = k + 1; j < largest; ++j) std::swap(A(j, k), A(largest, j));
      for (Eigen::Index j = largest + 1; j < n; ++j) std::swap(A(j, k), A(j, largest));
      std::swap(A(k, k), A(largest, largest));
      std::swap(order[k], order[largest]);
    }
    A(k, k) = std::sqrt(A(k, k));
    A.col(k).tail(n - k - 1) /= A(k, k);
    for (Eigen::Index j = k + 1; j < n; ++j) A.col(j).tail(n - j) -= A(j, k) * A.col(k).tail(n - j);
  }
  return static_cast<int>(n);
}

}  // namespace

void join_waiting_rows(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx,
                       std::span<const char> of_M, const double* row_size, const double* Lx, const double* D,
                       const SolvePanel& solve, WaitingRows& w) {
  const int width = static_cast<int>(w.rows.size());
  w.place.assign(K.n, -1);
  for (int c = 0; c < width; ++c) w.place[w.rows[c]] = c;
  take_scales(K, s, Kx, of_M, row_size, Lx, D, w);
  solve_for_Z(K, Kx, D, width, solve, w);

  w.L.assign(static_cast<std::size_t>(width) * width, 0.0);
  Rows A(w.L.data(), width, width);
  const Rows Z(w.Z.data(), K.n, width);
  each_entry_of_B(K, Kx, D, w, [&](int i, int c, double value) { A.row(c) += value * Z.row(i); });
  for (int i = 0; i < width; ++i)
    for (int j = 0; j <= i; ++j) A(i, j) = 0.5 * (A(i, j) + A(j, i)) * w.scale[i] * w.scale[j];
  w.order.resize(width);
  std::iota(w.order.begin(), w.order.end(), 0);
  w.joined = factorize_by_largest(A, w.order);

  // Reorders Z, the scales and the rows by w.order. Only columns of Z for rows that join remain.
  w.old_scale = w.scale, w.old_rows = w.rows;
  for (int c = 0; c < width; ++c) w.scale[c] = w.old_scale[w.order[c]], w.rows[c] = w.old_rows[w.order[c]];
  for (int k = 0; k < K.n; ++k)
    for (int c = 0; c < w.joined; ++c) w.B[static_cast<std::size_t>(k) * w.joined + c] = Z(k, w.order[c]);
  std::swap(w.Z, w.B);
}

void before_solve(WaitingRows& w, const int* row, const double* X, int ld, int cols) {
  const auto at = [&](int k) { return X + static_cast<std::ptrdiff_t>(row ? row[k] : k) * ld; };
  if (w.G.size() < static_cast<std::size_t>(w.joined) * cols) w.G.resize(static_cast<std::size_t>(w.joined) * cols);
  using Row = Eigen::Map<const Eigen::RowVectorXd>;
  Rows G(w.G.data(), w.joined, cols);
  for (int c = 0; c < w.joined; ++c) G.row(c) = Row(at(w.rows[c]), cols);
  const int n = static_cast<int>(w.place.size());
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < w.joined; ++c)
      if (const double z = w.Z[static_cast<std::size_t>(k) * w.joined + c]; z != 0) G.row(c) -= z * Row(at(k), cols);
  // Solves S y = G: y = -scale (L L^T)^-1 scale G.
  const std::size_t width = w.rows.size();
  for (int i = 0; i < w.joined; ++i) {
    G.row(i) *= -w.scale[i];
    for (int j = 0; j < i; ++j) G.row(i) -= w.L[i * width + j] * G.row(j);
    G.row(i) /= w.L[i * width + i];
  }
  for (int i = w.joined - 1; i >= 0; --i) {
    for (int j = i + 1; j < w.joined; ++j) G.row(i) -= w.L[j * width + i] * G.row(j);
    G.row(i) /= w.L[i * width + i];
  }
  for (int i = 0; i < w.joined; ++i) G.row(i) *= w.scale[i];
}

void after_solve(WaitingRows& w, const int* row, double* X, int ld, int cols) {
  const auto at = [&](int k) { return X + static_cast<std::ptrdiff_t>(row ? row[k] : k) * ld; };
  using Row = Eigen::Map<Eigen::RowVectorXd>;
  const Rows G(w.G.data(), w.joined, cols);
  const int n = static_cast<int>(w.place.size());
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < w.joined; ++c)
      if (const double z = w.Z[static_cast<std::size_t>(k) * w.joined + c]; z != 0) Row(at(k), cols) -= z * G.row(c);
  for (int c = 0; c < w.joined; ++c) Row(at(w.rows[c]), cols) = G.row(c);
}

}  // namespace manycontact::rank
