#include "manycontact/rank/dependent_rows.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "manycontact/rank/pivots.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/memory.hpp"
#include "manycontact/sparse/refine.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "manycontact/sparse/union_find.hpp"

namespace manycontact::rank {

bool DependentRows::accepted() const {
  return largest_residual <= tolerance::kRowLeft && largest_entry <= tolerance::kLargestEntry;
}

int ldl_factor_dependent(const sparse::UpperCsc& K, const sparse::LdlSymbolic& s, const double* Kx,
                         std::span<const char> of_M, double margin, const double* row_size, sparse::LdlWorkspace& w,
                         double* Lx, double* D, DependentRows& rows) {
  w.reserve(s);
  rows.dropped.clear();
  rows.turned.clear();
  rows.inverse.resize(s.n);
  rows.noise.resize(s.n);
  double* y = w.Y.data();  // may have any value: entry j is zero from step j on, between rows
  for (int k = 0; k < s.n; ++k) {
    // row k of L: L(0:k-1, 0:k-1) D l_k = K(0:k-1, k)
    double size = 0;  // largest entry of J's row
    for (int p = K.p[k]; p < K.p[k + 1]; ++p) {
      y[K.i[p]] = Kx[p];
      size = std::max(size, std::abs(Kx[p]));
    }
    double d = y[k], terms = std::abs(d), passed_on = 0;
    const double own = y[k];
    y[k] = 0;
    for (int p = s.Rp[k]; p < s.Rp[k + 1]; ++p) {
      const int j = s.Rj[p], end = s.Rk[p];
      const double yj = y[j], l = yj * rows.inverse[j];
      y[j] = 0;
      if (rows.inverse[j] == 0) {  // dropped
        Lx[end] = 0;
        continue;
      }
      for (int q = s.Lp[j]; q < end; ++q) y[s.Li[q]] -= Lx[q] * yj;
      Lx[end] = l;
      d -= l * yj;
      terms += std::abs(l * yj);
      if (!of_M[k] || !of_M[j]) passed_on += l * l * rows.noise[j];
    }
    // Rounding of its own terms, and of the pivots before it times what they are multiplied by here: a small pivot has
    // large multiples, and what it is wrong by may look like a pivot in a row that has none. (Not among rows of M,
    // which is definite: there nothing grows, and down a long tree the sum would.) A row of M after rows of J has what
    // these add, too: where that buries M's own entry, they had no pivot from the rows of M before them.
    rows.noise[k] = tolerance::kRowRounding * terms + passed_on;
    const Pivot<double> pivot{of_M[k] != 0, d, terms, of_M[k] ? own : size, row_size[k]};
    const bool left = std::abs(d) > rows.noise[k] && is_left(pivot, margin);
    if (!of_M[k] && !left && std::isfinite(terms)) {
      rows.dropped.push_back(k);
      D[k] = std::numeric_limits<double>::infinity();
      rows.inverse[k] = rows.noise[k] = 0;
      continue;
    }
    if (!left || !has_its_sign(pivot)) return k;
    D[k] = d;
    rows.inverse[k] = 1 / d;
  }
  return s.n;
}

namespace {

// residual <- J_k - sum_j z_j J_j for the last column of N; returns its largest entry relative to the rows' sizes.
// Entries are zero but for those touched.
double dependence_residual(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M,
                           const double* row_scale, DependentRows& rows) {
  std::vector<double>& residual = rows.residual;
  for (int i : rows.touched) residual[i] = 0;
  rows.touched.clear();
  double size = 0;
  for (int p = rows.Np[rows.Np.size() - 2]; p < rows.Np.back(); ++p) {
    const int k = rows.Ni[p];
    const auto add = [&](int column, double entry) {
      residual[column] += rows.Nx[p] * entry;
      rows.touched.push_back(column);
    };
    size = std::max(size, std::abs(rows.Nx[p]) * row_scale[k]);
    for (int q = K.p[k]; q < K.p[k + 1]; ++q)
      if (of_M[K.i[q]]) add(K.i[q], Kx[q]);
    for (int q = rows.Jp[k]; q < rows.Jp[k + 1]; q += 2) add(rows.Ji[q + 1], Kx[rows.Ji[q]]);
  }
  double largest = 0;
  for (int i : rows.touched) largest = sparse::larger_or_nan(largest, std::abs(residual[i]));
  return largest == 0 ? 0 : largest / size;
}

bool is_turned(const DependentRows& rows, int k) { return !rows.turned.empty() && rows.turned[k]; }

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
  sparse::ldl_solve(s, Lx, D, x);
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

// use(row of K, value) for each entry of columns of N or B.
template <class Use>
void each_entry(const std::vector<int>& p, const std::vector<int>& i, const std::vector<double>& x, int column,
                Use&& use) {
  for (int k = p[column]; k < p[column + 1]; ++k) use(i[k], x[k]);
}
// ... of a cluster's column of N.
template <class Use>
void each_of_null(const DependentRows& rows, const DependentRows::Cluster& cluster, int member, Use&& use) {
  each_entry(rows.Np, rows.Ni, rows.Nx, rows.members[cluster.first + member], use);
}
// ... of its column of B.
template <class Use>
void each_of_basis(const DependentRows& rows, const DependentRows::Cluster& cluster, int column, Use&& use) {
  each_entry(rows.Bp, rows.Bi, rows.Bx, cluster.basis + column, use);
}

// The rows of K that a cluster's columns of N are in: those dropped, then those kept.
void take_rows(DependentRows& rows, DependentRows::Cluster& cluster) {
  std::vector<int>& all = rows.cluster_rows;
  cluster.row = static_cast<int>(all.size());
  const auto add = [&](bool first) {
    for (int a = 0; a < cluster.count; ++a) {
      const int c = rows.members[cluster.first + a], begin = rows.Np[c];
      if (first)
        all.push_back(rows.Ni[begin]);
      else
        all.insert(all.end(), rows.Ni.begin() + begin + 1, rows.Ni.begin() + rows.Np[c + 1]);
    }
  };
  add(true);
  const auto kept = static_cast<std::ptrdiff_t>(all.size());
  add(false);
  std::sort(all.begin() + kept, all.end());
  all.erase(std::unique(all.begin() + kept, all.end()), all.end());
  cluster.row_end = static_cast<int>(all.size());
}

// [Z; 1] of a cluster, a column for each of its kept rows.
void take_complement(DependentRows& rows, DependentRows::Cluster& cluster) {
  std::vector<int>& place = rows.owner;  // next entry's place in the column of each kept row
  const int* kept = rows.cluster_rows.data() + cluster.row + cluster.count;
  for (int j = 0; j < cluster.size; ++j) place[kept[j]] = 1;
  const auto each = [&](auto&& use) {  // but the dropped rows' own
    for (int a = 0; a < cluster.count; ++a) {
      const int k = rows.dropped[rows.members[cluster.first + a]];
      each_of_null(rows, cluster, a, [&](int j, double value) {
        if (j != k) use(j, k, value);
      });
    }
  };
  each([&](int j, int, double) { ++place[j]; });
  for (int j = 0; j < cluster.size; ++j) {
    const int first = rows.Bp.back();
    rows.Bp.push_back(first + place[kept[j]]);
    place[kept[j]] = first;
  }
  rows.Bi.resize(rows.Bp.back());
  rows.Bx.resize(rows.Bp.back());
  const auto put = [&](int j, int row, double value) {
    rows.Bi[place[j]] = row;
    rows.Bx[place[j]++] = value;
  };
  for (int j = 0; j < cluster.size; ++j) put(kept[j], kept[j], 1);
  each([&](int j, int k, double value) { put(j, k, -value); });
}

// B of a cluster.
void take_basis(DependentRows& rows, DependentRows::Cluster& cluster) {
  const int kept = cluster.row_end - cluster.row - cluster.count;
  cluster.basis = static_cast<int>(rows.Bp.size()) - 1;
  cluster.complement = kept < cluster.count;
  cluster.size = cluster.complement ? kept : cluster.count;
  if (cluster.complement) return take_complement(rows, cluster);
  for (int a = 0; a < cluster.count; ++a) {
    each_of_null(rows, cluster, a, [&](int k, double value) { rows.Bi.push_back(k), rows.Bx.push_back(value); });
    rows.Bp.push_back(static_cast<int>(rows.Bi.size()));
  }
}

// Columns of N that share rows belong together.
void make_clusters(int n, DependentRows& rows) {
  const int d = static_cast<int>(rows.dropped.size());
  // one per row of K: a column of N with it, or -1; then one per column: the first column of its cluster
  std::vector<int>& owner = rows.owner;
  owner.assign(n + d, -1);
  sparse::UnionFind sets(std::span<int>(owner).subspan(n));
  for (int c = 0; c < d; ++c) {
    for (int p = rows.Np[c]; p < rows.Np[c + 1]; ++p) {
      int& of = owner[rows.Ni[p]];
      if (of >= 0) sets.join(of, c);
      of = c;
    }
  }
  constexpr std::size_t kReserved = 64 * 64;  // rows that clusters share may vary with rounding, and memory must not
  const std::size_t most = static_cast<std::size_t>(d) * d, entries = rows.Ni.capacity() + n;
  rows.members.clear();
  rows.cluster_rows.clear();
  rows.gram.clear();
  rows.Bp.assign(1, 0);
  rows.Bi.clear();
  rows.Bx.clear();
  rows.clusters.reserve(d);
  rows.members.reserve(d);
  rows.cluster_rows.reserve(entries);
  rows.gram.reserve(std::min(most, kReserved));
  rows.Bp.reserve(d + 1);
  rows.Bi.reserve(entries);
  rows.Bx.reserve(entries);
  rows.t.resize(d);
  for (int c = 0; c < d; ++c) {
    rows.members.push_back(c);
    owner[n + c] = sets.root(c);
  }
  const auto root = [&](int c) { return owner[n + c]; };
  std::sort(rows.members.begin(), rows.members.end(),
            [&](int a, int b) { return root(a) != root(b) ? root(a) < root(b) : a < b; });
  for (int next = 0; next < d;) {
    DependentRows::Cluster cluster;
    cluster.first = next;
    while (next < d && root(rows.members[next]) == root(rows.members[cluster.first])) ++next;
    cluster.count = next - cluster.first;
    take_rows(rows, cluster);
    take_basis(rows, cluster);
    const int first = rows.Bp[cluster.basis], end = rows.Bp[cluster.basis + cluster.size];
    rows.largest_cluster = std::max(rows.largest_cluster, end - first);
    const std::size_t square = static_cast<std::size_t>(cluster.size) * cluster.size;
    cluster.gram = rows.gram.size();
    sparse::require_memory(16.0 * static_cast<double>(square) + 24.0 * static_cast<double>(rows.Ni.size()));
    rows.gram.resize(rows.gram.size() + square);
    rows.clusters.push_back(cluster);
  }
}

void form_gram(int n, DependentRows& rows, const DependentRows::Cluster& cluster) {
  Eigen::Map<Eigen::MatrixXd> G(rows.gram.data() + cluster.gram, cluster.size, cluster.size);
  std::vector<double>& x = rows.x;
  x.assign(n, 0.0);
  for (int a = 0; a < cluster.size; ++a) {
    each_of_basis(rows, cluster, a, [&](int k, double value) { x[k] = value; });
    for (int b = 0; b < cluster.size; ++b) {
      double sum = 0;
      each_of_basis(rows, cluster, b, [&](int k, double value) { sum += value * x[k]; });
      G(a, b) = sum;
    }
    each_of_basis(rows, cluster, a, [&](int k, double) { x[k] = 0; });
  }
  Eigen::Ref<Eigen::MatrixXd> in_place(G);
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(in_place);
}

// The largest volume of N's square parts, or nearly: Goreinov, Oseledets, Savostyanov, Tyrtyshnikov, Zamarashkin, How
// to find a good submatrix (2010). With N = [1; -Z] in the rows dropped and kept, a turn of kept row i with dropped row
// j is a pivot on N_ij.
bool exchange_in_cluster(DependentRows& rows, const DependentRows::Cluster& cluster) {
  const int* row = rows.cluster_rows.data() + cluster.row;
  const std::size_t n = static_cast<std::size_t>(cluster.row_end - cluster.row);
  if (n * static_cast<std::size_t>(cluster.count) > tolerance::kMostExchanged) return false;
  if (rows.panel.size() < n * cluster.count) rows.panel.resize(n * cluster.count);
  Eigen::Map<Eigen::MatrixXd> N(rows.panel.data(), static_cast<Eigen::Index>(n), cluster.count);
  N.setZero();
  for (std::size_t i = 0; i < n; ++i) rows.owner[row[i]] = static_cast<int>(i);
  for (int a = 0; a < cluster.count; ++a)
    each_of_null(rows, cluster, a, [&](int k, double value) { N(rows.owner[k], a) = value; });
  bool exchanged = false;
  for (int turn = 0; turn < 50 * cluster.count; ++turn) {
    Eigen::Index i = 0, j = 0;
    const double largest = N.cwiseAbs().maxCoeff(&i, &j);
    if (!(largest > tolerance::kExchanged)) break;
    rows.dropped[rows.members[cluster.first + j]] = row[i];
    exchanged = true;
    N.col(j) /= N(i, j);
    for (Eigen::Index k = 0; k < N.cols(); ++k)
      if (k != j) N.col(k) -= N(i, k) * N.col(j);
  }
  for (int a = 0; exchanged && a < cluster.count; ++a) rows.turned[rows.dropped[rows.members[cluster.first + a]]] = 1;
  return exchanged;
}

// T's rows times (B^T B)^-1, with its factor.
template <class T>
void solve_gram(const DependentRows& rows, const DependentRows::Cluster& cluster, T&& t) {
  const int n = cluster.size;
  const Eigen::Map<const Eigen::MatrixXd> G(rows.gram.data() + cluster.gram, n, n);
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < a; ++b) t.row(a) -= G(a, b) * t.row(b);
    t.row(a) /= G(a, a);
  }
  for (int a = n - 1; a >= 0; --a) {
    for (int b = a + 1; b < n; ++b) t.row(a) -= G(b, a) * t.row(b);
    t.row(a) /= G(a, a);
  }
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
  rows.touched.reserve(K.nonzeros());  // the number of rows used varies with rounding, and memory must not
  rows.open.clear();
  rows.open.reserve(s.n);
  rows.is_open.assign(s.n, 0);
  take_later_entries(K, of_M, rows);
  rows.largest_residual = 0;
  for (int k : rows.dropped) {
    null_column(s, of_M, Lx, k, rows);
    const sparse::Refinement refinement = sparse::refine(
        tolerance::kNullColumnSteps, tolerance::kNullColumn,
        [&] { return dependence_residual(K, Kx, of_M, row_scale, rows); },
        [&] { refine_column(s, of_M, Lx, D, rows); });
    rows.largest_residual = sparse::larger_or_nan(rows.largest_residual, refinement.backward_error);
  }
  make_projector(s.n, rows);
}

void make_projector(int n, DependentRows& rows) {
  rows.largest_entry = 0;
  rows.largest_cluster = 0;
  rows.clusters.clear();
  for (double z : rows.Nx) rows.largest_entry = std::max(rows.largest_entry, std::abs(z));
  make_clusters(n, rows);
  for (const DependentRows::Cluster& cluster : rows.clusters) form_gram(n, rows, cluster);
}

bool exchange_rows(DependentRows& rows) {
  bool exchanged = false;
  rows.turned.assign(rows.inverse.size(), 0);
  for (const DependentRows::Cluster& cluster : rows.clusters)
    if (exchange_in_cluster(rows, cluster)) exchanged = true;
  std::sort(rows.dropped.begin(), rows.dropped.end());
  return exchanged;
}

std::span<const double> scale_of_dependent(DependentRows& rows, std::span<const double> scale) {
  rows.x.assign(scale.begin(), scale.end());
  for (std::size_t c = 0; c < rows.dropped.size(); ++c) {
    double sum = 0;
    for (int p = rows.Np[c]; p < rows.Np[c + 1]; ++p) sum += std::abs(rows.Nx[p]) * scale[rows.Ni[p]];
    rows.x[rows.Ni[rows.Np[c]]] = sum;
  }
  return rows.x;
}

void project_out(DependentRows& rows, double* y, double* null_component) {
  for (const DependentRows::Cluster& cluster : rows.clusters) {
    Eigen::Map<Eigen::VectorXd> t(rows.t.data(), cluster.size);
    t.setZero();
    for (int a = 0; a < cluster.size; ++a)
      each_of_basis(rows, cluster, a, [&](int k, double value) { t[a] += value * y[k]; });
    solve_gram(rows, cluster, t);
    if (cluster.complement) {  // I - P is the smaller projector: y becomes zero on the cluster, and B t is added again
      t = -t;
      for (int i = cluster.row; i < cluster.row_end; ++i) {
        const int k = rows.cluster_rows[i];
        if (null_component) null_component[k] += y[k];
        y[k] = 0;
      }
    }
    for (int a = 0; a < cluster.size; ++a)
      each_of_basis(rows, cluster, a, [&](int k, double value) {
        y[k] -= value * t[a];
        if (null_component) null_component[k] += value * t[a];
      });
  }
}

namespace {

// Whether a row that the cluster's columns of N are in is not zero; then none of them will be.
bool spread(const DependentRows& rows, const DependentRows::Cluster& cluster, char* nonzero) {
  const std::span<const int> of(rows.cluster_rows.data() + cluster.row, rows.cluster_rows.data() + cluster.row_end);
  const bool any = std::any_of(of.begin(), of.end(), [&](int k) { return nonzero[k] != 0; });
  for (int k : of) nonzero[k] = any;
  return any;
}

}  // namespace

void project_out_panel(DependentRows& rows, const int* row, double* X, int ld, int first, int cols, char* nonzero) {
  using Row = Eigen::Map<Eigen::RowVectorXd>;
  using Panel = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  constexpr int kColumns = 64;  // columns at a time; clusters may vary with rounding, and memory must not
  const std::size_t size = rows.dropped.size() * kColumns;
  if (rows.panel.size() < size) rows.panel.resize(size);
  for (const DependentRows::Cluster& cluster : rows.clusters) {
    if (nonzero && !spread(rows, cluster, nonzero)) continue;
    for (int c = first; c < first + cols; c += kColumns) {
      const int count = std::min(kColumns, first + cols - c);
      const auto at = [&](int k) { return Row(X + static_cast<std::ptrdiff_t>(row[k]) * ld + c, count); };
      Panel T(rows.panel.data(), cluster.size, count);
      T.setZero();
      for (int a = 0; a < cluster.size; ++a)
        each_of_basis(rows, cluster, a, [&](int k, double value) { T.row(a) += value * at(k); });
      solve_gram(rows, cluster, T);
      if (cluster.complement) {
        T = -T;
        for (int i = cluster.row; i < cluster.row_end; ++i) at(rows.cluster_rows[i]).setZero();
      }
      for (int a = 0; a < cluster.size; ++a)
        each_of_basis(rows, cluster, a, [&](int k, double value) { at(k) -= value * T.row(a); });
    }
  }
}

}  // namespace manycontact::rank
