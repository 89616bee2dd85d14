#include "manycontact/rank/dependent_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "manycontact/rank/pivots.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/tile.hpp"
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
    double size = 0;  // largest entry of row k of J in columns of M that are eliminated before it
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
    // If terms of rows of J eliminated before a row of M are much larger than M_kk, those rows had no sound pivot.
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

constexpr int kColumns = DependentRows::kColumns;
using Chunk = sparse::kernel::Tile<double, kColumns>;
using Errors = std::array<double, kColumns>;

double* row_of(std::vector<double>& panel, int k) { return panel.data() + static_cast<std::ptrdiff_t>(k) * kColumns; }

void add_row(double factor, const double* x, double* y) {
  Chunk sum = Chunk::load(y);
  sum.add(factor, x);
  sum.store(y);
}

// Sets the listed rows of a panel to zero, and clears the list.
void clear(std::vector<double>& panel, std::vector<int>& listed, DependentRows& rows) {
  for (int k : listed) {
    rows.met[k] = 0;
    std::fill_n(row_of(panel, k), kColumns, 0.0);
  }
  listed.clear();
}

// Computes rows.residual = J^T N for the panel's columns of N. Returns the largest residual of each column, relative to
// its largest entry of N times the size of the entry's row of J.
Errors dependence_residuals(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M,
                            const double* row_scale, DependentRows& rows) {
  clear(rows.residual, rows.touched, rows);
  Errors size{}, largest{};
  for (int k : rows.of_N) {
    const double* n = row_of(rows.N, k);
    for (int c = 0; c < kColumns; ++c) size[c] = std::max(size[c], std::abs(n[c]) * row_scale[k]);
    const auto add = [&](int column, double entry) {
      add_row(entry, n, row_of(rows.residual, column));
      if (!std::exchange(rows.met[column], 1)) rows.touched.push_back(column);
    };
    for (int q = K.p[k]; q < K.p[k + 1]; ++q)
      if (of_M[K.i[q]]) add(K.i[q], Kx[q]);
    for (int q = rows.Jp[k]; q < rows.Jp[k + 1]; q += 2) add(rows.Ji[q + 1], Kx[rows.Ji[q]]);
  }
  for (int k : rows.touched)
    for (int c = 0; c < kColumns; ++c)
      largest[c] = sparse::larger_or_nan(largest[c], std::abs(row_of(rows.residual, k)[c]));
  for (int c = 0; c < kColumns; ++c) largest[c] = largest[c] == 0 ? 0 : largest[c] / size[c];
  return largest;
}

// Whether row k was dropped by an exchange or after waiting (waiting_rows.hpp), and so may depend on later rows.
bool is_turned(const DependentRows& rows, int k) {
  const WaitingRows& w = rows.waiting;
  return (!rows.turned.empty() && rows.turned[k]) ||
         std::find(w.rows.begin() + w.joined, w.rows.end(), k) != w.rows.end();
}

// Lists, in rows.Jp and Ji, the entries of each row of J in columns whose row of M follows the row of J.
void take_later_entries(const sparse::UpperCsc& K, std::span<const char> of_M, DependentRows& rows) {
  rows.Jp.assign(K.n + 1, 0);
  rows.M_first = std::is_sorted(of_M.begin(), of_M.end(), std::greater<>());
  const auto each = [&](auto&& use) {
    bool any = false;  // whether a row of J precedes row k
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

// Computes in rows.N the columns e_k - z of N for up to kColumns dropped rows k. z solves L^T z = (row k of L), both
// restricted to rows of J before k.
void null_columns(const sparse::LdlSymbolic& s, std::span<const char> of_M, const double* Lx,
                  std::span<const int> dropped, DependentRows& rows) {
  const auto [least, last] = std::ranges::minmax(dropped);
  for (std::size_t c = 0; c < dropped.size(); ++c) row_of(rows.N, dropped[c])[c] = -1, rows.met[dropped[c]] = 1;
  int first = least;  // rows of the panel before `first` are zero
  for (int j = last; j >= first; --j) {
    if (!rows.met[j]) continue;
    double* n = row_of(rows.N, j);  // row j of the panel: entries -n_j, now complete
    bool any = false;
    for (int c = 0; c < kColumns; ++c) {
      n[c] = std::abs(n[c]) <= tolerance::kNullEntry ? 0 : -n[c];
      any = any || n[c] != 0;
    }
    rows.met[j] = any;
    if (!any) continue;
    rows.of_N.push_back(j);
    for (int p = s.Rp[j + 1] - 1; p >= s.Rp[j]; --p) {
      const int i = s.Rj[p];
      if (of_M[i] && rows.M_first) break;
      if (of_M[i]) continue;
      add_row(Lx[s.Rk[p]], n, row_of(rows.N, i));
      rows.met[i] = 1;
      first = std::min(first, i);
    }
  }
}

// Refines the panel's columns that `which` flags: z += K_kept^-1 (residual of z). This is needed if kept pivots were
// too small for accurate rows of L, or if an exchanged row also depends on later rows.
void refine_columns(std::span<const char> of_M, std::span<const int> dropped, const std::array<bool, kColumns>& which,
                    const SolvePanel& solve, DependentRows& rows) {
  const int n = static_cast<int>(of_M.size());
  std::array<int, kColumns> end{};  // column c may have entries only in rows before end[c]
  for (std::size_t c = 0; c < dropped.size(); ++c)
    end[c] = !which[c] ? 0 : is_turned(rows, dropped[c]) ? n : dropped[c];
  rows.x.assign(static_cast<std::size_t>(n) * kColumns, 0.0);
  for (int i : rows.touched)
    for (int c = 0; c < kColumns; ++c) row_of(rows.x, i)[c] = which[c] ? row_of(rows.residual, i)[c] : 0;
  solve_kept(rows, rows.x.data(), kColumns, kColumns, solve);
  for (int j = 0; j < n; ++j) {
    if (of_M[j]) continue;
    double *entry = row_of(rows.N, j), *x = row_of(rows.x, j);
    for (std::size_t c = 0; c < dropped.size(); ++c) {
      if (j >= end[c] || j == dropped[c]) continue;
      entry[c] -= x[c];
      if (std::abs(entry[c]) <= tolerance::kNullEntry) entry[c] = 0;
      if (entry[c] != 0 && !std::exchange(rows.met[j], 1)) rows.of_N.push_back(j);
    }
  }
}

void append_columns(std::span<const int> dropped, DependentRows& rows) {  // rows.N to Np, Ni, Nx
  std::ranges::sort(rows.of_N, std::greater<>());
  for (std::size_t c = 0; c < dropped.size(); ++c) {
    const auto append = [&](int k) { rows.Ni.push_back(k), rows.Nx.push_back(row_of(rows.N, k)[c]); };
    append(dropped[c]);
    for (int k : rows.of_N)
      if (k != dropped[c] && row_of(rows.N, k)[c] != 0) append(k);
    rows.Np.push_back(static_cast<int>(rows.Ni.size()));
  }
}

// Clears N and prepares the memory for its columns.
void begin_columns(const sparse::UpperCsc& K, std::span<const char> of_M, DependentRows& rows) {
  rows.Np.assign(1, 0);
  rows.Ni.clear();
  rows.Nx.clear();
  rows.plain.clear();
  rows.largest_residual = 0;
  if (rows.dropped.empty()) return;
  rows.met.assign(K.n, 0);
  for (std::vector<double>* panel : {&rows.N, &rows.residual})
    panel->assign(static_cast<std::size_t>(K.n) * kColumns, 0.0);
  // Reserves the largest sizes: refinements and numbers of listed rows vary with rounding errors, but memory must not.
  rows.x.reserve(static_cast<std::size_t>(K.n) * kColumns);
  for (std::vector<int>* listed : {&rows.of_N, &rows.touched}) listed->clear(), listed->reserve(K.n);
  take_later_entries(K, of_M, rows);
}

// Computes the columns of N for the dropped rows from rows.dropped[first] on, and appends them to N.
void find_columns(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx, std::span<const char> of_M,
                  const double* row_scale, const double* Lx, const SolvePanel& solve, std::size_t first,
                  DependentRows& rows) {
  for (; first < rows.dropped.size(); first += kColumns) {
    const auto dropped =
        std::span(rows.dropped).subspan(first).first(std::min<std::size_t>(kColumns, rows.dropped.size() - first));
    null_columns(s, of_M, Lx, dropped, rows);
    Errors before, error = dependence_residuals(K, Kx, of_M, row_scale, rows);
    before.fill(std::numeric_limits<double>::infinity());
    for (int step = 0; step < tolerance::kNullColumnSteps; ++step) {  // refines columns while their error halves
      std::array<bool, kColumns> which{};
      for (int c = 0; c < kColumns; ++c) which[c] = error[c] > tolerance::kNullColumn && error[c] < 0.5 * before[c];
      if (std::ranges::count(which, true) == 0) break;
      refine_columns(of_M, dropped, which, solve, rows);
      before = error;
      error = dependence_residuals(K, Kx, of_M, row_scale, rows);
    }
    append_columns(dropped, rows);
    clear(rows.N, rows.of_N, rows);
    for (std::size_t c = 0; c < dropped.size(); ++c) {
      rows.largest_residual = sparse::larger_or_nan(rows.largest_residual, error[c]);
      rows.plain.push_back(error[c] <= tolerance::kRowLeft);
    }
  }
}

// Moves dropped rows whose dependence is not certain (not flagged in rows.plain) to the waiting rows, and removes their
// columns of N. Returns the number of dropped rows that remain.
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
  rows.largest_residual = 0;  // residuals of the remaining columns are at most kRowLeft
  return plain;
}

void take_projector(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M, const double* row_scale,
                    DependentRows& rows) {
  make_projector(K.n, rows);
  for (const DependentRows::Cluster& cluster : rows.clusters) {
    if (cluster.kind != cluster.kOrthonormal) continue;
    for (int first = cluster.basis, end = first + cluster.size; first < end; first += kColumns) {
      rows.of_N.assign(rows.cluster_rows.begin() + cluster.row, rows.cluster_rows.begin() + cluster.row_end);
      for (int a = first; a < std::min(first + kColumns, end); ++a)
        for (int p = rows.Bp[a]; p < rows.Bp[a + 1]; ++p) row_of(rows.N, rows.Bi[p])[a - first] = rows.Bx[p];
      for (double left : dependence_residuals(K, Kx, of_M, row_scale, rows))
        rows.largest_residual = sparse::larger_or_nan(rows.largest_residual, left);
      clear(rows.N, rows.of_N, rows);
    }
  }
}

}  // namespace

void solve_kept(DependentRows& rows, double* X, int ld, int cols, const SolvePanel& solve) {
  if (rows.waiting.joined > 0) before_solve(rows.waiting, nullptr, X, ld, cols);
  solve(X, ld, cols);
  if (rows.waiting.joined > 0) after_solve(rows.waiting, nullptr, X, ld, cols);
}

void find_null_space(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx,
                     std::span<const char> of_M, const double* row_scale, const double* Lx, const SolvePanel& solve,
                     DependentRows& rows) {
  begin_columns(K, of_M, rows);
  find_columns(K, s, Kx, of_M, row_scale, Lx, solve, 0, rows);
  take_projector(K, Kx, of_M, row_scale, rows);
}

bool find_dependence(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx,
                     std::span<const char> of_M, const double* row_size, const double* Lx, const double* D,
                     const SolvePanel& solve, DependentRows& rows) {
  begin_columns(K, of_M, rows);
  find_columns(K, s, Kx, of_M, row_size, Lx, solve, 0, rows);
  if (std::ranges::count(rows.plain, 0) > 0) {
    const std::size_t plain = keep_plain_columns(rows);
    const WaitingRows& waiting = rows.waiting;
    join_waiting_rows(K, s, Kx, of_M, row_size, Lx, D, solve, rows.waiting);
    rows.dropped.insert(rows.dropped.end(), waiting.rows.begin() + waiting.joined, waiting.rows.end());
    std::sort(rows.dropped.begin() + static_cast<std::ptrdiff_t>(plain), rows.dropped.end());
    find_columns(K, s, Kx, of_M, row_size, Lx, solve, plain, rows);
  }
  take_projector(K, Kx, of_M, row_size, rows);
  return rows.accepted();
}

}  // namespace manycontact::rank
