// Changes J so that rows that are dependent up to the scene's inaccuracy or constraint violation become exactly so.
//
// Example: a redundant row k of a closed loop is J_k = sum_j z_j J_j. If the scene has four digits, or a constraint
// violation of 1e-6 m, J_k differs from this sum by a small remainder r. Without a change of J, the row would lock the
// loop with forces of order 1 / |r|. N, a basis of the null space of J^T, has one column n_k = e_k - z per such row
// (rank/dependent_rows.hpp). Each column c of J is changed by
//
//     J_c <- J_c - N_c (N_c^T N_c)^+ N_c^T J_c      N_c: the rows of N in which column c of J has entries
//
// This is the least change within the pattern of J after which N^T J = 0. J is changed only if in each column the root
// mean square of the change is at most the largest error of an entry. This error is the tolerance t for rows in m at
// coordinates in rad, and t / L for others, where L is the largest moment arm. The solve uses the changed J; residuals
// and error bounds include the change.
//
// N is found by an LDL of [D J^T; J 0]. The diagonal D replaces M, as masses do not affect dependence: 1 for
// coordinates in m, L^2 for coordinates in rad. A row of J unrelated to the dependence gets entries of size r in N. If
// a column c of J has only such rows, the formula above would remove all of J_c. Columns of N with such entries are
// computed again with D_c = |N_c|^2, which minimises the change of J, not N^T J (iteratively reweighted least squares).
//
// The tolerance t is the larger of two:
//   - Scene::tolerance, for any number of rows;
//   - the effect of constraint violation, for as many rows as were dependent at the start of the motion. The loop
//     closes at q + dq with [D J^T; J 0] [dq; y] = [0; -e], e the contact errors. The step dq rotates axes and moment
//     arms of J by up to sum_j |dq_j|, so t = 2 L sum_j |dq_j|.

#include "within_tolerance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "../../internal.hpp"
#include "manycontact/rank/dependent_rows.hpp"
#include "manycontact/sparse/decompositions.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "matrix.hpp"

namespace manycontact {

struct WithinTolerance::Work {
  std::vector<char> turns;                                         // whether each coordinate is in rad
  std::vector<int> contact, row;                                   // one entry per row of J: contact, row in it
  std::vector<std::vector<std::pair<int, Eigen::Index>>> columns;  // one list per coordinate: contact, column

  // set by find: [D J^T; J 0] as K, its factor L, D, and thresholds for rows of J
  std::vector<double> K, L, D, row_scale;
  sparse::LdlWorkspace ldl;
  rank::DependentRows rows;
  double lever = 1, tolerance = 0;  // L, the largest moment arm [m]; t, the error of rows of J in m
  std::vector<double> x;            // scratch, in K's order: a solution with K
  std::vector<double> n;            // a column of N, in K's order
  // Per coordinate c: n^T J_c; |n|^T |J_c|; sum_j |n_j| e_j; sum_j (n_j e_j)^2. e_j: error_of_entry of J_jc.
  Eigen::VectorXd left, terms, explained, weight;
  std::vector<RowChange> changes;
};

WithinTolerance::WithinTolerance() = default;
WithinTolerance::~WithinTolerance() = default;

namespace {

using Work = WithinTolerance::Work;

void take_island(const Scene& scene, const IslandWork& d, Work& w) {
  w.turns.clear();
  for (int r : d.island.robots)
    for (const Joint& joint : scene.robots[r].model->joints)
      for (int k = 0; k < joint.nv(); ++k) w.turns.push_back(internal::is_angular(joint, k));
  if (!w.columns.empty()) return;  // `columns`, `contact` and `row` are constant for the island's shape
  w.columns.resize(d.island.nv);
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k) {
    for (int i = 0; i < scene.contacts[d.island.contacts[k]].rows(); ++i)
      w.contact.push_back(static_cast<int>(k)), w.row.push_back(i);
    const std::vector<int>& columns = d.shape->support().columns[k];
    for (std::size_t j = 0; j < columns.size(); ++j)
      w.columns[columns[j]].emplace_back(static_cast<int>(k), static_cast<Eigen::Index>(j));
  }
}

// Returns the largest moment arm, i.e. the displacement of a point [m] per radian; 1 without rotations.
double largest_lever(const Workspace& work, const IslandWork& d, const Work& w) {
  double L = 0;
  for (int c = 0; c < d.island.nv; ++c)
    for (const auto& [k, j] : w.columns[c])
      if (const Eigen::MatrixXd& J = work.contacts[d.island.contacts[k]].J; w.turns[c])
        L = std::max(L, J.col(j).head(std::min<Eigen::Index>(J.rows(), 3)).cwiseAbs().maxCoeff());
  return L > 0 && std::isfinite(L) ? L : 1;
}

void find_null_space(const KktPattern& p, Work& w) {
  std::fill(w.row_scale.begin(), w.row_scale.end(), 1.0);
  const auto solve = [&](double* X, int ld, int cols) {
    sparse::ldl_solve_panel(p.ldl, w.L.data(), w.D.data(), nullptr, X, ld, 0, cols, nullptr);
  };
  rank::find_null_space(p.K, p.ldl, w.K.data(), p.of_M, w.row_scale.data(), w.L.data(), solve, w.rows);
}

// Factorizes [D J^T; J 0] with so much damping in the rows w.rows.dropped that these rows have no effect.
bool factorize_without_dropped(const KktPattern& p, Work& w) {
  for (int k : w.rows.dropped) w.K[p.K.p[k + 1] - 1] = -tolerance::kDroppedDamping;
  const bool factorized = sparse::ldl_factor(p.K, p.ldl, w.K.data(), w.ldl, w.L.data(), w.D.data()) == p.size();
  for (int k : w.rows.dropped) w.K[p.K.p[k + 1] - 1] = 0, w.D[k] = std::numeric_limits<double>::infinity();
  return factorized;
}

// Factorizes [D J^T; J 0] without rows whose pivot is below `left` times its terms, and computes N. If entries of N
// exceed kLargestEntry, drops other rows. Returns whether N can be used.
bool factorize(const Workspace& work, const IslandWork& d, const KktPattern& p, double left, Work& w) {
  w.K.assign(p.K.nonzeros(), 0.0);
  for (int c = 0; c < p.nv; ++c) w.K[p.K.p[p.iperm[c] + 1] - 1] = w.turns[c] ? w.lever * w.lever : 1;
  const int* slot = p.J_slot.data();
  for (int c : d.island.contacts)
    for (double value : work.contacts[c].J.reshaped()) w.K[*slot++] = value;
  const double margin = left / tolerance::kPivotLeft;
  w.row_scale.assign(p.size(), 0.0);  // drops rows whose entries are below sqrt(left) times their possible size
  for (int r = 0; r < p.nc; ++r)
    w.row_scale[p.iperm[p.nv + r]] = std::sqrt(left) * (w.row[r] < 3 ? w.lever : 1) / (margin * tolerance::kRank);
  w.L.resize(p.ldl.nonzeros()), w.D.resize(p.size());
  if (rank::ldl_factor_dependent(p.K, p.ldl, w.K.data(), p.of_M, margin, w.row_scale.data(), w.ldl, w.L.data(),
                                 w.D.data(), w.rows) != p.size())
    w.rows.dropped.clear();  // J is not finite: no factor
  if (w.rows.dropped.empty()) return false;
  w.rows.turned.assign(p.size(), 0);  // a small row may depend on larger, later rows
  for (int k : w.rows.dropped) w.rows.turned[k] = 1;
  find_null_space(p, w);
  if (w.rows.largest_entry <= tolerance::kLargestEntry) return true;
  if (!rank::exchange_rows(w.rows) || !factorize_without_dropped(p, w)) return false;
  find_null_space(p, w);
  return w.rows.largest_entry <= tolerance::kLargestEntry;
}

// Returns the error t of those rows of J that are in m, due to constraint violation.
double drift(const Scene& scene, const Workspace& work, const IslandWork& d, const KktPattern& p, Work& w) {
  w.x.assign(p.size(), 0.0);
  int row = 0;
  for (int c : d.island.contacts) {
    const Eigen::VectorXd e = work.contacts[c].W * contact_error<double>(scene.contacts[c], work.contacts[c].G);
    for (double of_row : e) w.x[p.iperm[p.nv + row++]] = -of_row;
  }
  sparse::ldl_solve(p.ldl, w.L.data(), w.D.data(), w.x.data());
  double most = 0;
  for (const std::vector<int>& columns : d.shape->support().columns) {
    double sum = 0;
    for (int c : columns) sum += (w.turns[c] ? w.lever : 1) * std::abs(w.x[p.iperm[c]]);
    most = std::max(most, 2 * sum);
  }
  return std::max(most, tolerance::kRank * w.lever);
}

double error_of_entry(const Work& w, int row, int coordinate) {  // error of an entry of J, divided by w.tolerance
  return w.row[row] < 3 && w.turns[coordinate] ? 1 : 1 / w.lever;
}

// Whether changes within the errors of J can make J^T n = 0, where n = w.n is a column of N.
bool is_explained(const Workspace& work, const IslandWork& d, const KktPattern& p, Work& w) {
  for (Eigen::VectorXd* sum : {&w.left, &w.terms, &w.explained, &w.weight}) sum->setZero(p.nv);
  for (int row = 0; row < p.nc; ++row) {
    const double n = w.n[p.iperm[p.nv + row]];
    if (n == 0) continue;
    const auto J = work.contacts[d.island.contacts[w.contact[row]]].J.row(w.row[row]);
    const std::vector<int>& columns = d.shape->support().columns[w.contact[row]];
    for (std::size_t j = 0; j < columns.size(); ++j) {
      const int c = columns[j];
      const double term = n * J[static_cast<Eigen::Index>(j)], error = std::abs(n) * error_of_entry(w, row, c);
      w.left[c] += term, w.terms[c] += std::abs(term);
      w.explained[c] += error, w.weight[c] += error * error;
    }
  }
  return (w.left.array().abs() <= tolerance::kNullColumn * w.terms.array() ||
          w.left.array().abs() <= w.tolerance * w.explained.array())
      .all();
}

// Recomputes column w.n of N with D_c = |N_c|^2, by K^-1 times its residual. K is [D J^T; J 0] of the kept rows.
bool reweigh(const KktPattern& p, Work& w) {
  for (int c = 0; c < p.nv; ++c) {
    const double unit = w.turns[c] ? w.lever * w.lever : 1;
    w.K[p.K.p[p.iperm[c] + 1] - 1] = std::max(tolerance::kLeastWeight * unit, w.lever * w.lever * w.weight[c]);
  }
  if (!factorize_without_dropped(p, w)) return false;
  w.x.assign(p.size(), 0.0);
  for (int c = 0; c < p.nv; ++c) w.x[p.iperm[c]] = w.left[c];
  sparse::ldl_solve(p.ldl, w.L.data(), w.D.data(), w.x.data());
  for (int k = 0; k < p.size(); ++k)
    if (!p.of_M[k]) w.n[k] -= w.x[k];
  return true;
}

// Recomputes each column n of N until changes within J's errors suffice for J^T n = 0. Returns false if this fails.
bool settle(const Workspace& work, const IslandWork& d, const KktPattern& p, Work& w) {
  rank::DependentRows& rows = w.rows;
  std::vector<int> Np{0}, Ni;
  std::vector<double> Nx;
  for (std::size_t column = 0; column < rows.dropped.size(); ++column) {
    w.n.assign(p.size(), 0.0);
    for (int k = rows.Np[column]; k < rows.Np[column + 1]; ++k) w.n[rows.Ni[k]] = rows.Nx[k];
    for (int step = 0;; ++step) {
      for (double& entry : w.n)
        if (std::abs(entry) <= tolerance::kRank) entry = 0;  // a rounding error, as the dropped row has entry 1
      if (is_explained(work, d, p, w)) break;
      if (step == tolerance::kReweighted || !reweigh(p, w)) return false;
    }
    const auto add = [&](int k) { Ni.push_back(k), Nx.push_back(w.n[k]); };
    add(rows.dropped[column]);
    for (int k = 0; k < p.size(); ++k)
      if (w.n[k] != 0 && k != rows.dropped[column]) add(k);
    Np.push_back(static_cast<int>(Ni.size()));
  }
  rows.Np.swap(Np), rows.Ni.swap(Ni), rows.Nx.swap(Nx);
  rank::make_projector(p.size(), rows);
  return rows.largest_entry <= tolerance::kLargestEntry;
}

// Computes the change of column c of J. Returns whether J's errors permit it. N: one row per entry of `rows` of J.
bool take_change(const Workspace& work, const IslandWork& d, const std::vector<int>& rows, const Eigen::MatrixXd& N,
                 int c, Work& w) {
  std::vector<RowChange> change;
  std::vector<Eigen::Index> in_N;
  for (const auto& [contact, j] : w.columns[c])
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (w.contact[rows[i]] == contact) {
        change.push_back({rows[i], c, work.contacts[d.island.contacts[contact]].J(w.row[rows[i]], j)});
        in_N.push_back(static_cast<Eigen::Index>(i));
      }
  if (change.empty()) return true;
  Eigen::VectorXd J_c(in_N.size());
  double error = 0;  // the largest error of entries of J_c
  for (Eigen::Index i = 0; i < J_c.size(); ++i) {
    J_c[i] = change[i].value;
    error = std::max(error, w.tolerance * error_of_entry(w, change[i].row, c));
  }
  const Eigen::MatrixXd Nt = N(in_N, Eigen::all).transpose();
  const Eigen::VectorXd left = Nt * J_c;
  const auto rounding = [&](const Eigen::VectorXd& sizes) -> Eigen::ArrayXd {
    return tolerance::kNullColumn * (Nt.cwiseAbs() * sizes).array();
  };
  if ((left.array().abs() <= rounding(J_c.cwiseAbs())).all()) return true;  // rows are dependent without a change
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition(Nt.rows(), Nt.cols());
  decomposition.setThreshold(tolerance::kRank);
  const Eigen::VectorXd part = decomposition.compute(Nt).solve(left);
  if (!(part.norm() <= error * std::sqrt(static_cast<double>(part.size()))) ||
      !((Nt * part - left).array().abs() <= rounding(J_c.cwiseAbs() + part.cwiseAbs())).all())
    return false;
  for (Eigen::Index i = 0; i < J_c.size(); ++i) {
    change[i].value = -part[i];
    w.changes.push_back(change[i]);
  }
  return true;
}

// Computes the change of J for one cluster, i.e. columns of N that share rows. Returns whether J's errors permit it.
bool take_changes(const Workspace& work, const IslandWork& d, const KktPattern& p,
                  const rank::DependentRows::Cluster& cluster, Work& w) {
  std::vector<int> rows;  // rows of J in the cluster
  const auto each = [&](auto&& use) {
    for (int m = 0; m < cluster.count; ++m) {
      const int n = w.rows.members[cluster.first + m];
      for (int k = w.rows.Np[n]; k < w.rows.Np[n + 1]; ++k) use(p.perm[w.rows.Ni[k]] - p.nv, m, w.rows.Nx[k]);
    }
  };
  each([&](int row, int, double) { rows.push_back(row); });
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), cluster.count);
  each([&](int row, int m, double value) {
    N(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin(), m) = value;
  });
  for (int c = 0; c < p.nv; ++c)
    if (!take_change(work, d, rows, N, c, w)) return false;
  return true;
}

// Finds N and the change of J. Tries ever smaller thresholds for dropping rows. Returns false if no change is found.
bool find(const Scene& scene, const Workspace& work, const IslandWork& d, const KktPattern& p, Work& w) {
  const double most = tolerance::kMostDrift * w.lever;
  const double largest = d.depended > 0 ? most : std::min(scene.tolerance, most);
  const double generous = tolerance::kLargestEntry * largest / w.lever;
  for (double left = generous * generous;; left *= tolerance::kNextPivot) {
    left = std::max(left, tolerance::kPivotLeft);
    bool within = factorize(work, d, p, left, w);
    if (w.rows.dropped.empty()) return false;
    w.tolerance = scene.tolerance;
    if (within && static_cast<int>(w.rows.dropped.size()) <= d.depended)
      w.tolerance = std::max(w.tolerance, drift(scene, work, d, p, w));
    w.tolerance = std::min(w.tolerance, most);
    within = within && w.tolerance > 0 && settle(work, d, p, w);
    w.changes.clear();
    for (std::size_t k = 0; within && k < w.rows.clusters.size(); ++k)
      within = take_changes(work, d, p, w.rows.clusters[k], w);
    if (within || left == tolerance::kPivotLeft) return within;
  }
}

}  // namespace

double WithinTolerance::make_dependent(const Scene& scene, Workspace& work, const IslandWork& d) {
  if (!work_) work_ = std::make_unique<Work>();
  Work& w = *work_;
  take_island(scene, d, w);
  w.lever = largest_lever(work, d, w);
  const KktPattern& p = *d.shape->pattern(Order::kLeafToRoot);
  if (!find(scene, work, d, p, w)) return 0;
  for (const RowChange& change : w.changes) {
    const std::vector<int>& columns = d.shape->support().columns[w.contact[change.row]];
    const auto j = std::find(columns.begin(), columns.end(), change.column) - columns.begin();
    work.contacts[d.island.contacts[w.contact[change.row]]].J(w.row[change.row], j) += change.value;
  }
  double largest = 0;  // the largest sum_j |n_j| of a column n of N
  for (std::size_t n = 0; n + 1 < w.rows.Np.size(); ++n)
    largest = std::max(largest, std::accumulate(w.rows.Nx.begin() + w.rows.Np[n], w.rows.Nx.begin() + w.rows.Np[n + 1],
                                                0.0, [](double sum, double x) { return sum + std::abs(x); }));
  constexpr int kFactors = 4;  // error terms of N^T dJ/dt v: from N, and from changes of J and of v at bodies A and B
  return kFactors * largest * w.tolerance / w.lever;
}

std::span<const RowChange> WithinTolerance::changes() const {
  return work_ ? std::span<const RowChange>(work_->changes) : std::span<const RowChange>();
}

double WithinTolerance::inaccuracy(int coordinate) const {
  return work_->turns[coordinate] ? work_->tolerance : work_->tolerance / work_->lever;
}

bool is_inexact(const Scene& scene, const IslandWork& d) {
  return d.island.nc > 0 && (scene.tolerance > 0 || d.depended > 0);
}

}  // namespace manycontact
