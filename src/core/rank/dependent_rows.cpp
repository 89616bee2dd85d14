#include "manycontact/rank/dependent_rows.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "manycontact/rank/pivots.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/refine.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::rank {

bool DependentRows::accepted() const {
  return largest_residual <= tolerance::kRowLeft && largest_projected <= tolerance::kLargestEntry;
}

void least_pivots(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M, double margin,
                  const double* row_size, std::vector<double>& least) {
  least.assign(K.n, 0.0);
  for (int k = 0; k < K.n; ++k) {
    if (of_M[k]) continue;
    double size = 0;  // largest entry of row k of J in columns of M before it
    for (int p = K.p[k]; p < K.p[k + 1]; ++p) size = std::max(size, std::abs(Kx[p]));
    const bool vanishes = !(size > margin * tolerance::kRank * row_size[k]);
    least[k] = vanishes ? std::numeric_limits<double>::infinity() : margin * tolerance::kPivotLeft;
  }
}

int take_waiting_rows(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M, int most,
                      const double* terms, double* D, DependentRows& rows) {
  rows.dropped.clear();
  rows.turned.clear();
  rows.waiting.rows.clear();
  rows.waiting.joined = 0;
  for (int k = 0; k < K.n; ++k) {
    if (!of_M[k] && !(std::abs(D[k]) > rows.least[k] * terms[k]) && std::isfinite(terms[k])) {
      if (std::ssize(rows.dropped) == most) return k;
      rows.dropped.push_back(k);
      D[k] = std::numeric_limits<double>::infinity();
      continue;
    }
    // Rows of J add terms to the pivot of a later row of M. If these dominate M's own entry, the rows of J had no sound
    // pivot from the rows of M before them.
    const Pivot<double> pivot{of_M[k] != 0, D[k], terms[k], Kx[K.p[k + 1] - 1]};
    if (!(of_M[k] ? is_left(pivot) : std::isfinite(terms[k])) || !has_its_sign(pivot)) return k;
  }
  return K.n;
}

int ldl_factor_dependent(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx,
                         std::span<const char> of_M, double margin, const double* row_size, sparse::LdlWorkspace& w,
                         double* Lx, double* D, DependentRows& rows) {
  least_pivots(K, Kx, of_M, margin, row_size, rows.least);
  rows.terms.resize(K.n);
  sparse::ldl_factor_by_rows(K, s, Kx, rows.least.data(), w, Lx, D, rows.terms.data());
  return take_waiting_rows(K, Kx, of_M, K.n, rows.terms.data(), D, rows);
}

namespace {

// residual <- J^T times a column of N or B with entries (i, x). Returns its largest entry relative to the rows' sizes.
// Only entries in `touched` may be non-zero.
double dependence_residual(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M,
                           const double* row_scale, std::span<const int> i, std::span<const double> x,
                           DependentRows& rows) {
  std::vector<double>& residual = rows.residual;
  for (int k : rows.touched) residual[k] = 0;
  rows.touched.clear();
  double size = 0;
  for (std::size_t p = 0; p < i.size(); ++p) {
    const int k = i[p];
    const auto add = [&](int column, double entry) {
      residual[column] += x[p] * entry;
      rows.touched.push_back(column);
    };
    size = std::max(size, std::abs(x[p]) * row_scale[k]);
    for (int q = K.p[k]; q < K.p[k + 1]; ++q)
      if (of_M[K.i[q]]) add(K.i[q], Kx[q]);
    for (int q = rows.Jp[k]; q < rows.Jp[k + 1]; q += 2) add(rows.Ji[q + 1], Kx[rows.Ji[q]]);
  }
  double largest = 0;
  for (int k : rows.touched) largest = sparse::larger_or_nan(largest, std::abs(residual[k]));
  return largest == 0 ? 0 : largest / size;
}

// Whether row k was dropped by an exchange, or still waits. Such a row may depend on later rows.
bool is_turned(const DependentRows& rows, int k) {
  const WaitingRows& w = rows.waiting;
  return (!rows.turned.empty() && rows.turned[k]) ||
         std::find(w.rows.begin() + w.joined, w.rows.end(), k) != w.rows.end();
}

// Finds J's entries in later rows of M.
void take_later_entries(const sparse::UpperCsc& K, std::span<const char> of_M, DependentRows& rows) {
  rows.Jp.assign(K.n + 1, 0);
  rows.M_first = std::is_sorted(of_M.begin(), of_M.end(), std::greater<>());
  const auto each = [&](auto&& use) {
    bool any = false;  // rows of J so far
    for (int k = 0; k < K.n; ++k) {
      any = any || !of_M[k];
      for (int p = K.p[k]; any && of_M[k] && p < K.p[k + 1]; ++p)
        if (!of_M[K.i[p]]) use(K.i[p], p, k);
    }
  };
  each([&](int row, int, int) { rows.Jp[row + 1] += 2; });
  for (int k = 0; k < K.n; ++k) rows.Jp[k + 1] += rows.Jp[k];
  rows.Ji.resize(rows.Jp.back());
  each([&](int row, int slot, int column) {
    int& next = rows.Jp[row];
    rows.Ji[next++] = slot, rows.Ji[next++] = column;
  });
  for (int k = K.n; k > 0; --k) rows.Jp[k] = rows.Jp[k - 1];
  rows.Jp[0] = 0;
}

// Solves L^T z = l_k over the rows of J before k, and appends the column e_k - z of N.
void null_column(const sparse::LdlSymbolic& s, std::span<const char> of_M, const double* Lx, int k,
                 DependentRows& rows) {
  double* x = rows.x.data();
  int first = k;  // x has no entries before it
  const auto add_row = [&](int j, double factor) {
    for (int p = s.Rp[j + 1] - 1; p >= s.Rp[j]; --p) {
      const int i = s.Rj[p];
      if (of_M[i] && rows.M_first) break;
      if (of_M[i]) continue;
      x[i] += Lx[s.Rk[p]] * factor;
      first = std::min(first, i);
    }
  };
  rows.Ni.push_back(k);
  rows.Nx.push_back(1);
  add_row(k, 1);
  for (int j = k - 1; j >= first; --j) {
    const double xj = std::exchange(x[j], 0);
    if (std::abs(xj) <= tolerance::kNullEntry) continue;
    rows.Ni.push_back(j);
    rows.Nx.push_back(-xj);
    add_row(j, -xj);
  }
  rows.Np.push_back(static_cast<int>(rows.Ni.size()));
}

// Refines z by K_kept^-1 (its residual), if pivots were too small for l_k, or an exchanged row depends on later rows.
void refine_column(const sparse::LdlSymbolic& s, std::span<const char> of_M, const double* Lx, const double* D,
                   DependentRows& rows) {
  const int first = rows.Np[rows.Np.size() - 2];
  double* x = rows.x.data();
  std::copy(rows.residual.begin(), rows.residual.end(), x);
  solve_kept(rows, x, [&](double* y) { sparse::ldl_solve(s, Lx, D, y); });
  const int k = rows.Ni[first];
  for (std::size_t p = first + 1; p < rows.Ni.size(); ++p) x[rows.Ni[p]] -= rows.Nx[p];  // z
  rows.Ni.resize(first + 1);
  rows.Nx.resize(first + 1);
  for (int j = (is_turned(rows, k) ? s.n : k) - 1; j >= 0; --j) {
    if (of_M[j] || j == k || std::abs(x[j]) <= tolerance::kNullEntry) continue;
    rows.Ni.push_back(j);
    rows.Nx.push_back(-x[j]);
  }
  std::fill_n(x, s.n, 0.0);
  rows.Np.back() = static_cast<int>(rows.Ni.size());
}

// Prepares the memory for the columns to be found.
void begin_columns(const sparse::UpperCsc& K, std::span<const char> of_M, DependentRows& rows) {
  rows.Np.assign(1, 0);
  rows.Ni.clear();
  rows.Nx.clear();
  rows.plain.clear();
  rows.touched.clear();
  rows.largest_residual = 0;
  if (rows.dropped.empty()) return;
  rows.x.assign(K.n, 0.0);
  rows.residual.assign(K.n, 0.0);
  rows.touched.reserve(K.nonzeros());  // the number used varies with rounding errors, and memory must not
  take_later_entries(K, of_M, rows);
}

// Computes and appends the columns of N of the rows from rows.dropped[first] on.
void find_columns(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx, std::span<const char> of_M,
                  const double* row_scale, const double* Lx, const double* D, std::size_t first, DependentRows& rows) {
  for (std::size_t c = first; c < rows.dropped.size(); ++c) {
    null_column(s, of_M, Lx, rows.dropped[c], rows);
    const sparse::Refinement refinement = sparse::refine(
        tolerance::kNullColumnSteps, tolerance::kNullColumn,
        [&] {
          const std::size_t begin = rows.Np[rows.Np.size() - 2];
          return dependence_residual(K, Kx, of_M, row_scale, std::span(rows.Ni).subspan(begin),
                                     std::span(rows.Nx).subspan(begin), rows);
        },
        [&] { refine_column(s, of_M, Lx, D, rows); });
    rows.largest_residual = sparse::larger_or_nan(rows.largest_residual, refinement.backward_error);
    rows.plain.push_back(refinement.backward_error <= tolerance::kRowLeft);
  }
}

// Keeps the rows that certainly depend, and their columns; the others wait. Returns the number of rows kept.
std::size_t keep_plain_columns(DependentRows& rows) {
  std::size_t plain = 0;
  int end = 0;
  for (std::size_t c = 0; c < rows.dropped.size(); ++c) {
    if (!rows.plain[c]) {
      rows.waiting.rows.push_back(rows.dropped[c]);
      continue;
    }
    const int first = rows.Np[c], count = rows.Np[c + 1] - first;
    std::copy_n(rows.Ni.begin() + first, count, rows.Ni.begin() + end);
    std::copy_n(rows.Nx.begin() + first, count, rows.Nx.begin() + end);
    rows.dropped[plain++] = rows.dropped[c];
    rows.Np[plain] = end += count;
  }
  rows.dropped.resize(plain);
  rows.Np.resize(plain + 1);
  rows.Ni.resize(end);
  rows.Nx.resize(end);
  rows.largest_residual = 0;  // the kept columns leave at most kRowLeft
  return plain;
}

void take_projector(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M, const double* row_scale,
                    DependentRows& rows) {
  make_projector(K.n, rows);
  for (const DependentRows::Cluster& cluster : rows.clusters) {
    if (cluster.kind != cluster.kOrthonormal) continue;
    for (int a = cluster.basis; a < cluster.basis + cluster.size; ++a) {
      const std::size_t first = rows.Bp[a], count = rows.Bp[a + 1] - first;
      const double left = dependence_residual(K, Kx, of_M, row_scale, std::span(rows.Bi).subspan(first, count),
                                              std::span(rows.Bx).subspan(first, count), rows);
      rows.largest_residual = sparse::larger_or_nan(rows.largest_residual, left);
    }
  }
}

}  // namespace

void find_null_space(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx,
                     std::span<const char> of_M, const double* row_scale, const double* Lx, const double* D,
                     DependentRows& rows) {
  begin_columns(K, of_M, rows);
  find_columns(K, s, Kx, of_M, row_scale, Lx, D, 0, rows);
  take_projector(K, Kx, of_M, row_scale, rows);
}

bool find_dependence(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx,
                     std::span<const char> of_M, const double* row_size, const double* Lx, const double* D,
                     DependentRows& rows) {
  begin_columns(K, of_M, rows);
  find_columns(K, s, Kx, of_M, row_size, Lx, D, 0, rows);
  if (std::ranges::count(rows.plain, 0) > 0) {
    const std::size_t plain = keep_plain_columns(rows);
    const WaitingRows& waiting = rows.waiting;
    join_waiting_rows(K, s, Kx, of_M, row_size, Lx, D, rows.waiting);
    rows.dropped.insert(rows.dropped.end(), waiting.rows.begin() + waiting.joined, waiting.rows.end());
    std::sort(rows.dropped.begin() + static_cast<std::ptrdiff_t>(plain), rows.dropped.end());
    find_columns(K, s, Kx, of_M, row_size, Lx, D, plain, rows);
  }
  take_projector(K, Kx, of_M, row_size, rows);
  return rows.accepted();
}

}  // namespace manycontact::rank
