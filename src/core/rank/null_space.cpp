// The projector on J^T's null space, from its basis N with a column per dropped row (rank/dependent_rows.hpp). Columns
// of N that share rows form a cluster, which has a basis B of its own. Rows may be exchanged to limit N's entries.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "manycontact/rank/dependent_rows.hpp"
#include "manycontact/sparse/memory.hpp"
#include "manycontact/sparse/tile.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "manycontact/sparse/union_find.hpp"

namespace manycontact::rank {

namespace {

// Calls use(row of K, value) for each entry of a column of N or B, whose columns are stored as p, i, x.
template <class Use>
void each_entry(const std::vector<int>& p, const std::vector<int>& i, const std::vector<double>& x, int column,
                Use&& use) {
  for (int k = p[column]; k < p[column + 1]; ++k) use(i[k], x[k]);
}
template <class Use>
void each_of_null(const DependentRows& rows, const DependentRows::Cluster& cluster, int member, Use&& use) {
  each_entry(rows.Np, rows.Ni, rows.Nx, rows.members[cluster.first + member], use);
}
template <class Use>
void each_of_basis(const DependentRows& rows, const DependentRows::Cluster& cluster, int column, Use&& use) {
  each_entry(rows.Bp, rows.Bi, rows.Bx, cluster.basis + column, use);
}

// Lists the rows of K in which a cluster's columns of the null-space basis N have entries, dropped before kept rows.
void take_rows(DependentRows& rows, DependentRows::Cluster& cluster) {
  constexpr int kListed = -2;  // marks a row as listed, in rows.owner
  std::vector<int>& all = rows.cluster_rows;
  cluster.row = static_cast<int>(all.size());
  for (int a = 0; a < cluster.count; ++a) all.push_back(rows.Ni[rows.Np[rows.members[cluster.first + a]]]);
  const auto kept = static_cast<std::ptrdiff_t>(all.size());
  for (int a = 0; a < cluster.count; ++a) {
    const int c = rows.members[cluster.first + a];
    for (int p = rows.Np[c] + 1; p < rows.Np[c + 1]; ++p)
      if (std::exchange(rows.owner[rows.Ni[p]], kListed) != kListed) all.push_back(rows.Ni[p]);
  }
  std::sort(all.begin() + kept, all.end());
  cluster.row_end = static_cast<int>(all.size());
}

// Sets a cluster's basis B to [Z^T; 1], with a column per kept row: the orthogonal complement of its columns [1; -Z]
// of the null-space basis N.
void take_complement(DependentRows& rows, DependentRows::Cluster& cluster) {
  cluster.kind = cluster.kComplement;
  std::vector<int>& place = rows.owner;  // numbers of entries of kept rows' columns, then positions of the next entries
  const int* kept = rows.cluster_rows.data() + cluster.row + cluster.count;
  for (int j = 0; j < cluster.size; ++j) place[kept[j]] = 1;
  const auto each = [&](auto&& use) {  // calls use for all entries of N except the dropped rows' own
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

bool is_small(const DependentRows::Cluster& cluster) {
  return static_cast<std::size_t>(cluster.row_end - cluster.row) * cluster.count <= tolerance::kMostExchanged;
}
// Returns a cluster's columns of N as a dense matrix over the cluster's rows, stored in rows.panel.
Eigen::Map<Eigen::MatrixXd> dense_columns(DependentRows& rows, const DependentRows::Cluster& cluster) {
  const int n = cluster.row_end - cluster.row;
  const std::size_t size = static_cast<std::size_t>(n) * cluster.count;
  if (rows.panel.size() < size) rows.panel.resize(size);
  Eigen::Map<Eigen::MatrixXd> N(rows.panel.data(), n, cluster.count);
  N.setZero();
  for (int i = 0; i < n; ++i) rows.owner[rows.cluster_rows[cluster.row + i]] = i;
  for (int a = 0; a < cluster.count; ++a)
    each_of_null(rows, cluster, a, [&](int k, double value) { N(rows.owner[k], a) = value; });
  return N;
}

// Sets a cluster's B to an orthonormal basis of its columns of N, by two Gram-Schmidt passes, largest remainder first
// (Golub, Van Loan, Matrix Computations, sec. 5.2.9). Errors J^T n grow by |column| / |remainder|.
void take_orthonormal(DependentRows& rows, DependentRows::Cluster& cluster) {
  Eigen::Map<Eigen::MatrixXd> N = dense_columns(rows, cluster);
  for (auto column : N.colwise()) column.normalize();
  for (int a = 0; a < cluster.count; ++a) {
    Eigen::Index largest = 0;
    (void)N.rightCols(cluster.count - a).colwise().squaredNorm().maxCoeff(&largest);
    if (largest > 0) N.col(a).swap(N.col(a + largest));
    for (int b = 0; b < a; ++b) N.col(a) -= N.col(b).dot(N.col(a)) * N.col(b);
    N.col(a).normalize();
    for (int b = a + 1; b < cluster.count; ++b) N.col(b) -= N.col(a).dot(N.col(b)) * N.col(a);
  }
  cluster.basis = static_cast<int>(rows.Bp.size()) - 1;
  cluster.size = cluster.count;
  cluster.kind = cluster.kOrthonormal;
  for (int a = 0; a < cluster.count; ++a) {
    rows.Bi.insert(rows.Bi.end(), rows.cluster_rows.begin() + cluster.row, rows.cluster_rows.begin() + cluster.row_end);
    rows.Bx.insert(rows.Bx.end(), N.col(a).begin(), N.col(a).end());
    rows.Bp.push_back(static_cast<int>(rows.Bi.size()));
  }
}

double largest_entry(const DependentRows& rows, const DependentRows::Cluster& cluster) {
  double largest = 0;
  for (int a = 0; a < cluster.count; ++a)
    each_of_null(rows, cluster, a, [&](int, double value) { largest = std::max(largest, std::abs(value)); });
  return largest;
}

// Computes a cluster's basis B. In small clusters whose columns of N have large entries it is orthonormal. Otherwise it
// consists of these columns or of their orthogonal complement, whichever has fewer columns.
void take_basis(DependentRows& rows, DependentRows::Cluster& cluster) {
  const double largest = largest_entry(rows, cluster);
  rows.largest_entry = std::max(rows.largest_entry, largest);
  if (largest > tolerance::kLargestEntry && is_small(cluster)) return take_orthonormal(rows, cluster);
  rows.largest_projected = std::max(rows.largest_projected, largest);
  const int kept = cluster.row_end - cluster.row - cluster.count;
  cluster.basis = static_cast<int>(rows.Bp.size()) - 1;
  cluster.size = std::min(kept, cluster.count);
  if (kept < cluster.count) return take_complement(rows, cluster);
  for (int a = 0; a < cluster.count; ++a) {
    const int c = rows.members[cluster.first + a], first = rows.Np[c], end = rows.Np[c + 1];
    rows.Bi.insert(rows.Bi.end(), rows.Ni.begin() + first, rows.Ni.begin() + end);
    rows.Bx.insert(rows.Bx.end(), rows.Nx.begin() + first, rows.Nx.begin() + end);
    rows.Bp.push_back(static_cast<int>(rows.Bi.size()));
  }
}

void make_clusters(int n, DependentRows& rows) {
  const int d = static_cast<int>(rows.dropped.size());
  // owner[k], row k of K: a column of N with an entry there, or -1. owner[n + c], column c: its cluster's first column.
  std::vector<int>& owner = rows.owner;
  owner.assign(n + d, -1);
  sparse::UnionFind sets(std::span<int>(owner).subspan(n));
  for (int c = 0; c < d; ++c) {
    int joined = -1;
    for (int p = rows.Np[c]; p < rows.Np[c + 1]; ++p) {
      const int of = std::exchange(owner[rows.Ni[p]], c);
      if (of >= 0 && of != joined) sets.join(joined = of, c);
    }
  }
  constexpr std::size_t kReserved = 64 * 64;  // a constant, as clusters vary with rounding errors, but memory must not
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
  using Chunk = sparse::kernel::Tile<double, DependentRows::kColumns>;
  constexpr int kColumns = DependentRows::kColumns;
  Eigen::Map<Eigen::MatrixXd> G(rows.gram.data() + cluster.gram, cluster.size, cluster.size);
  if (rows.N.size() < static_cast<std::size_t>(n) * kColumns)
    rows.N.assign(static_cast<std::size_t>(n) * kColumns, 0.0);
  const auto row = [&](int k) { return rows.N.data() + static_cast<std::ptrdiff_t>(k) * kColumns; };
  for (int a = 0; a < cluster.size; a += kColumns) {
    const int count = std::min(kColumns, cluster.size - a);
    for (int i = 0; i < count; ++i)
      each_of_basis(rows, cluster, a + i, [&](int k, double value) { row(k)[i] = value; });
    for (int b = a; b < cluster.size; ++b) {  // the lower half of B^T B
      Chunk sum = Chunk::all(0);
      each_of_basis(rows, cluster, b, [&](int k, double value) { sum.add(value, row(k)); });
      double products[kColumns];
      sum.store(products);
      std::copy_n(products, count, G.row(b).segment(a, count).begin());
    }
    for (int i = 0; i < count; ++i) each_of_basis(rows, cluster, a + i, [&](int k, double) { row(k)[i] = 0; });
  }
  Eigen::Ref<Eigen::MatrixXd> in_place(G);
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(in_place);
}

// Exchanges dropped with kept rows until the block of N in the dropped rows has nearly the largest volume: exchanging
// kept row i with dropped row j is a pivot step on N_ij, N = [1; -Z]. Returns whether rows were exchanged. Source:
// Goreinov, Oseledets, Savostyanov, Tyrtyshnikov, Zamarashkin, How to find a good submatrix (2010).
bool exchange_in_cluster(DependentRows& rows, const DependentRows::Cluster& cluster) {
  if (!is_small(cluster)) return false;
  const int* row = rows.cluster_rows.data() + cluster.row;
  Eigen::Map<Eigen::MatrixXd> N = dense_columns(rows, cluster);
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

// Overwrites t with (B^T B)^-1 t, by the Cholesky factor of B^T B in rows.gram.
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

// Calls use(cluster) for each cluster, and twice if its basis is orthonormal. N has large entries in this case, as its
// kept rows are small, and the second projection removes the rounding errors of the first.
template <class Use>
void each_projection(const DependentRows& rows, Use&& use) {
  for (const DependentRows::Cluster& cluster : rows.clusters)
    for (int time = 0; time < (cluster.kind == cluster.kOrthonormal ? 2 : 1); ++time) use(cluster);
}

}  // namespace

void make_projector(int n, DependentRows& rows) {
  rows.largest_entry = rows.largest_projected = 0;
  rows.largest_cluster = 0;
  rows.clusters.clear();
  if (rows.dropped.empty()) return;
  make_clusters(n, rows);
  for (const DependentRows::Cluster& cluster : rows.clusters) form_gram(n, rows, cluster);
}

bool exchange_rows(DependentRows& rows) {
  bool exchanged = false;
  rows.turned.assign(rows.least.size(), 0);
  for (const DependentRows::Cluster& cluster : rows.clusters)
    if (exchange_in_cluster(rows, cluster)) exchanged = true;
  std::sort(rows.dropped.begin(), rows.dropped.end());
  return exchanged;
}

std::span<const double> scale_of_dependent(DependentRows& rows, std::span<const double> scale) {
  if (rows.dropped.empty()) return scale;
  rows.x.assign(scale.begin(), scale.end());
  for (std::size_t c = 0; c < rows.dropped.size(); ++c) {
    double sum = 0;
    for (int p = rows.Np[c]; p < rows.Np[c + 1]; ++p) sum += std::abs(rows.Nx[p]) * scale[rows.Ni[p]];
    rows.x[rows.Ni[rows.Np[c]]] = sum;
  }
  return rows.x;
}

void project_out(DependentRows& rows, double* y, double* null_component) {
  each_projection(rows, [&](const DependentRows::Cluster& cluster) {
    Eigen::Map<Eigen::VectorXd> t(rows.t.data(), cluster.size);
    t.setZero();
    for (int a = 0; a < cluster.size; ++a)
      each_of_basis(rows, cluster, a, [&](int k, double value) { t[a] += value * y[k]; });
    solve_gram(rows, cluster, t);
    if (cluster.kind ==
        cluster.kComplement) {  // B spans the range of I - P: sets y to zero on the cluster, then adds B t
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
  });
}

namespace {

// Returns whether any of the cluster's rows is flagged nonzero; if so, flags all: the projection makes them nonzero.
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
  constexpr int kColumns = 64;  // columns at a time; a constant, as clusters vary with rounding, but memory must not
  const std::size_t size = rows.dropped.size() * kColumns;
  if (rows.panel.size() < size) rows.panel.resize(size);
  each_projection(rows, [&](const DependentRows::Cluster& cluster) {
    if (nonzero && !spread(rows, cluster, nonzero)) return;
    for (int c = first; c < first + cols; c += kColumns) {
      const int count = std::min(kColumns, first + cols - c);
      const auto at = [&](int k) { return Row(X + static_cast<std::ptrdiff_t>(row[k]) * ld + c, count); };
      Panel T(rows.panel.data(), cluster.size, count);
      T.setZero();
      for (int a = 0; a < cluster.size; ++a)
        each_of_basis(rows, cluster, a, [&](int k, double value) { T.row(a) += value * at(k); });
      solve_gram(rows, cluster, T);
      if (cluster.kind == cluster.kComplement) {
        T = -T;
        for (int i = cluster.row; i < cluster.row_end; ++i) at(rows.cluster_rows[i]).setZero();
      }
      for (int a = 0; a < cluster.size; ++a)
        each_of_basis(rows, cluster, a, [&](int k, double value) { at(k) -= value * T.row(a); });
    }
  });
}

}  // namespace manycontact::rank
