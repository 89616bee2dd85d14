#include "manycontact/rank/dependent_rows.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

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
    double size = 0;  // largest entry of J's row in the columns before it
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
    // A row of M after rows of J has what these add, too: where that buries M's own entry, they had no pivot from the
    // rows of M before them.
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

// residual <- J^T times a column of N or B, whose entries are i, x; returns its largest entry relative to the rows'
// sizes. Entries are zero but for those touched.
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

// Whether row k was dropped in another's place, or waited: it may depend on later rows.
bool is_turned(const DependentRows& rows, int k) {
  const WaitingRows& w = rows.waiting;
  return (!rows.turned.empty() && rows.turned[k]) ||
         std::find(w.rows.begin() + w.joined, w.rows.end(), k) != w.rows.end();
}

// Finds J's entries in rows of M after them.
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

// L^T z = l_k over the rows of J before k, and the column e_k - z of N.
void null_column(const sparse::LdlSymbolic& s, std::span<const char> of_M, const double* Lx, int k,
                 DependentRows& rows) {
  double* x = rows.x.data();
  std::vector<int>& open = rows.open;  // a heap of the rows that x has entries in: the last comes first
  const auto add = [&](int j, double entry) {
    x[j] += entry;
    if (rows.is_open[j]) return;
    rows.is_open[j] = 1;
    open.push_back(j);
    std::push_heap(open.begin(), open.end());
  };
  for (int p = s.Rp[k]; p < s.Rp[k + 1]; ++p)
    if (!of_M[s.Rj[p]]) add(s.Rj[p], Lx[s.Rk[p]]);
  rows.Ni.push_back(k);
  rows.Nx.push_back(1);
  while (!open.empty()) {
    std::pop_heap(open.begin(), open.end());
    const int j = open.back();
    open.pop_back();
    rows.is_open[j] = 0;
    const double xj = x[j];
    x[j] = 0;
    if (std::abs(xj) <= tolerance::kNullEntry) continue;
    rows.Ni.push_back(j);
    rows.Nx.push_back(-xj);
    for (int p = s.Rp[j + 1] - 1; p >= s.Rp[j]; --p) {
      if (!of_M[s.Rj[p]])
        add(s.Rj[p], -Lx[s.Rk[p]] * xj);
      else if (rows.M_first)
        break;
    }
  }
  rows.Np.push_back(static_cast<int>(rows.Ni.size()));
}

// z += K_kept^-1 of what z leaves, when the pivots kept were too small for l_k to be accurate, or a row that was turned
// depends on later rows, too.
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

}  // namespace

void find_null_space(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx,
                     std::span<const char> of_M, const double* row_scale, const double* Lx, const double* D,
                     DependentRows& rows) {
  rows.Np.assign(1, 0);
  rows.Ni.clear();
  rows.Nx.clear();
  rows.x.assign(s.n, 0.0);
  rows.residual.assign(s.n, 0.0);
  rows.touched.clear();
  rows.largest_residual = 0;
  if (rows.dropped.empty()) return make_projector(s.n, rows);
  rows.touched.reserve(K.nonzeros());  // the number of rows used varies with rounding, and memory must not
  rows.open.clear();
  rows.open.reserve(s.n);
  rows.is_open.assign(s.n, 0);
  take_later_entries(K, of_M, rows);
  rows.plain.clear();
  for (int k : rows.dropped) {
    null_column(s, of_M, Lx, k, rows);
    const sparse::Refinement refinement = sparse::refine(
        tolerance::kNullColumnSteps, tolerance::kNullColumn,
        [&] {
          const std::size_t first = rows.Np[rows.Np.size() - 2];
          return dependence_residual(K, Kx, of_M, row_scale, std::span(rows.Ni).subspan(first),
                                     std::span(rows.Nx).subspan(first), rows);
        },
        [&] { refine_column(s, of_M, Lx, D, rows); });
    rows.largest_residual = sparse::larger_or_nan(rows.largest_residual, refinement.backward_error);
    rows.plain.push_back(refinement.backward_error <= tolerance::kRowLeft);
  }
  make_projector(s.n, rows);
  for (const DependentRows::Cluster& cluster : rows.clusters)
    for (int a = cluster.basis; cluster.orthonormal && a < cluster.basis + cluster.size; ++a) {
      const std::size_t first = rows.Bp[a], count = rows.Bp[a + 1] - first;
      const double left = dependence_residual(K, Kx, of_M, row_scale, std::span(rows.Bi).subspan(first, count),
                                              std::span(rows.Bx).subspan(first, count), rows);
      rows.largest_residual = sparse::larger_or_nan(rows.largest_residual, left);
    }
}

bool find_dependence(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx,
                     std::span<const char> of_M, const double* row_size, const double* Lx, const double* D,
                     DependentRows& rows) {
  find_null_space(K, s, Kx, of_M, row_size, Lx, D, rows);
  if (rows.accepted()) return true;
  std::vector<int>& waiting = rows.waiting.rows;
  std::size_t plain = 0;
  for (std::size_t c = 0; c < rows.dropped.size(); ++c)
    if (const int k = rows.dropped[c]; rows.plain[c])
      rows.dropped[plain++] = k;
    else
      waiting.push_back(k);
  join_waiting_rows(K, s, Kx, of_M, row_size, Lx, D, rows.waiting);
  std::copy(waiting.begin() + rows.waiting.joined, waiting.end(),
            rows.dropped.begin() + static_cast<std::ptrdiff_t>(plain));
  rows.dropped.resize(plain + waiting.size() - rows.waiting.joined);
  std::sort(rows.dropped.begin(), rows.dropped.end());
  find_null_space(K, s, Kx, of_M, row_size, Lx, D, rows);
  return rows.accepted();
}

}  // namespace manycontact::rank
