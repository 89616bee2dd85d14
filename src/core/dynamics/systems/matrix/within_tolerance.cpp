// Rows of J that depend on each other but for inaccuracy of the scene or drift are made to depend on each other.
//
// A closed loop drawn with four digits, or one that has drifted by 1e-6 m, has rows J_k = sum_j z_j J_j + r with a
// small r where the mechanism has r = 0. Solved as they are, such rows lock the loop, by forces that are 1 / |r| too
// large. With the columns n_k = e_k - z of N (rank/dependent_rows.hpp), each column c of J loses its part in N:
//
//     J_c <- J_c - N_c (N_c^T N_c)^+ N_c^T J_c      N_c: those rows of N that column c has
//
// This is the least change within the pattern of J after which N^T J = 0. Factors, refinement, derivatives, products
// and bounds are of this J.
//
// N is found by an LDL of [D J^T; J 0] with a diagonal D in place of M, since masses have no part in this: 1 for
// coordinates in m, L^2 for those in rad, L being the largest moment arm. A dependence counts where it leaves no more
// than the rows themselves are off by: |r_c| <= sum_j |n_j| times the tolerance t. Rows and coordinates in rad are
// weighed by L. There are two tolerances:
//   - of the scene, for any number of rows;
//   - of drift, for as many rows as depended at the start. The closed loop is nearest at q + dq, where dq solves
//     [D J^T; J 0] [dq; y] = [0; -e] for the contact errors e and the rows kept. A joint between here and there turns
//     the axes and the moment arms of J by |dq_j|, so that t = 2 L sum_j |dq_j|.

#include "within_tolerance.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "../../internal.hpp"
#include "manycontact/rank/dependent_rows.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "matrix.hpp"

namespace manycontact {

struct WithinTolerance::Work {
  // of the island
  std::vector<char> turns;                                         // per coordinate: in rad
  std::vector<int> contact, row;                                   // per row of J
  std::vector<std::vector<std::pair<int, Eigen::Index>>> columns;  // per coordinate: contacts that have it, and where

  // by find
  std::vector<double> K, L, D, row_scale;
  sparse::LdlWorkspace ldl;
  std::vector<char> of_M;
  rank::DependentRows rows;
  Eigen::VectorXd left;
  double lever = 1, tolerance = 0;  // the largest [m]; error of those rows of J [m]
  std::vector<double> dq;           // to the nearest closed loop, in K's order
};

WithinTolerance::WithinTolerance() = default;
WithinTolerance::~WithinTolerance() = default;

namespace {

using Work = WithinTolerance::Work;

void fill_turning(const Model& model, char* turns) {
  for (const Joint& joint : model.joints) {
    char* at = turns + joint.idx_v;
    switch (joint.type) {
      case JointType::kPrismatic:
        at[0] = 0;
        break;
      case JointType::kPlanar:
        at[0] = at[1] = 0, at[2] = 1;
        break;
      case JointType::kFloating:
        for (int i = 0; i < 6; ++i) at[i] = i >= 3;
        break;
      default:
        std::fill_n(at, joint.nv(), 1);
    }
  }
}

void take_island(const Scene& scene, const IslandWork& d, Work& w) {
  w.turns.assign(d.island.nv, 0);
  for (std::size_t k = 0; k < d.island.robots.size(); ++k)
    fill_turning(*scene.robots[d.island.robots[k]].model, w.turns.data() + d.island.dof_offset[k]);
  if (!w.columns.empty()) return;  // the rest is the shape's
  w.columns.resize(d.island.nv);
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k) {
    for (int i = 0; i < scene.contacts[d.island.contacts[k]].rows(); ++i)
      w.contact.push_back(static_cast<int>(k)), w.row.push_back(i);
    const std::vector<int>& columns = d.shape->support().columns[k];
    for (std::size_t j = 0; j < columns.size(); ++j)
      w.columns[columns[j]].emplace_back(static_cast<int>(k), static_cast<Eigen::Index>(j));
  }
}

// The largest moment arm: metres that a point moves by for a radian; 1 where nothing rotates.
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
  rank::find_null_space(p.K, p.ldl, w.K.data(), w.of_M, w.row_scale.data(), w.L.data(), w.D.data(), w.rows);
}

// [D J^T; J 0] without the rows in w.rows.dropped, as if these were damped beyond all numbers.
bool factorize_without_dropped(const KktPattern& p, Work& w) {
  for (int k : w.rows.dropped) w.K[p.K.p[k + 1] - 1] = -tolerance::kDroppedDamping;
  const bool factorized = sparse::ldl_factor(p.K, p.ldl, w.K.data(), w.ldl, w.L.data(), w.D.data()) == p.size();
  for (int k : w.rows.dropped) w.K[p.K.p[k + 1] - 1] = 0, w.D[k] = std::numeric_limits<double>::infinity();
  return factorized;
}

// Drops rows with less than `left` of their pivot, or others in their place where those kept are much smaller. Whether
// rows were dropped and N can be used.
bool factorize(const Workspace& work, const IslandWork& d, const KktPattern& p, double L, double left, Work& w) {
  w.K.assign(p.K.nonzeros(), 0.0);
  for (int c = 0; c < p.nv; ++c) w.K[p.K.p[p.iperm[c] + 1] - 1] = w.turns[c] ? L * L : 1;
  const int* slot = p.J_slot.data();
  for (int c : d.island.contacts)
    for (double value : work.contacts[c].J.reshaped()) w.K[*slot++] = value;
  const double margin = left / tolerance::kPivotLeft;
  w.row_scale.assign(p.size(), 0.0);  // all of a row is dropped where it is below sqrt(left) of what it could be
  for (int r = 0; r < p.nc; ++r)
    w.row_scale[p.iperm[p.nv + r]] = std::sqrt(left) * (w.row[r] < 3 ? L : 1) / (margin * tolerance::kRank);
  w.L.resize(p.ldl.nonzeros()), w.D.resize(p.size());
  w.of_M.assign(p.size(), 0);
  std::fill_n(w.of_M.begin(), p.nv, 1);  // leaf-to-root
  if (rank::ldl_factor_dependent(p.K, p.ldl, w.K.data(), w.of_M, margin, w.row_scale.data(), w.ldl, w.L.data(),
                                 w.D.data(), w.rows) != p.size())
    w.rows.dropped.clear();  // not finite
  if (w.rows.dropped.empty()) return false;
  w.rows.turned.assign(p.size(), 0);  // a small row may depend on larger ones after it
  for (int k : w.rows.dropped) w.rows.turned[k] = 1;
  find_null_space(p, w);
  if (w.rows.largest_entry <= tolerance::kLargestEntry) return true;
  if (!rank::exchange_rows(w.rows) || !factorize_without_dropped(p, w)) return false;
  find_null_space(p, w);
  return w.rows.largest_entry <= tolerance::kLargestEntry;
}

// The error of the rows of J from contacts that are not closed [m].
double drift(const Scene& scene, const Workspace& work, const IslandWork& d, const KktPattern& p, double L, Work& w) {
  w.dq.assign(p.size(), 0.0);
  int row = 0;
  for (int c : d.island.contacts) {
    const Eigen::VectorXd e = work.contacts[c].W * contact_error<double>(scene.contacts[c], work.contacts[c].G);
    for (double of_row : e) w.dq[p.iperm[p.nv + row++]] = -of_row;
  }
  sparse::ldl_solve(p.ldl, w.L.data(), w.D.data(), w.dq.data());
  double most = 0;
  for (const std::vector<int>& columns : d.shape->support().columns) {
    double sum = 0;
    for (int c : columns) sum += (w.turns[c] ? L : 1) * std::abs(w.dq[p.iperm[c]]);
    most = std::max(most, 2 * sum);
  }
  return std::max(most, tolerance::kRank * L);
}

// Whether column n of N leaves no more than the tolerance.
bool is_within(const Workspace& work, const IslandWork& d, const KktPattern& p, double L, int n, Work& w) {
  w.left.setZero(p.nv);
  double of_points = 0, of_turning = 0;  // what a row in m and in rad is off by, for a coordinate in rad
  for (int k = w.rows.Np[n]; k < w.rows.Np[n + 1]; ++k) {
    const int row = p.perm[w.rows.Ni[k]] - p.nv, contact = w.contact[row];
    const auto of_row = work.contacts[d.island.contacts[contact]].J.row(w.row[row]);
    const std::vector<int>& columns = d.shape->support().columns[contact];
    for (std::size_t j = 0; j < columns.size(); ++j)
      w.left[columns[j]] += w.rows.Nx[k] * of_row[static_cast<Eigen::Index>(j)];
    (w.row[row] < 3 ? of_points : of_turning) += std::abs(w.rows.Nx[k]) * w.tolerance;
  }
  for (int c = 0; c < p.nv; ++c)
    if (!(std::abs(w.left[c]) <= (w.turns[c] ? of_points : of_points / L) + of_turning / L)) return false;
  return true;
}

// Finds the columns of N, or none. The more rows are to be distinguished, the smaller a pivot may be.
bool find(const Scene& scene, const Workspace& work, const IslandWork& d, const KktPattern& p, double L, Work& w) {
  const double most = tolerance::kMostDrift * L, largest = d.depended > 0 ? most : std::min(scene.tolerance, most);
  const double generous = tolerance::kLargestEntry * largest / L;
  for (double left = generous * generous;; left *= tolerance::kNextPivot) {
    left = std::max(left, tolerance::kPivotLeft);
    bool within = factorize(work, d, p, L, left, w);
    if (w.rows.dropped.empty()) return false;
    const int count = static_cast<int>(w.rows.dropped.size());
    w.tolerance = scene.tolerance;
    if (within && count <= d.depended) w.tolerance = std::max(w.tolerance, drift(scene, work, d, p, L, w));
    w.tolerance = std::min(w.tolerance, most);
    for (int n = 0; within && n < count; ++n) within = is_within(work, d, p, L, n, w);
    if (within || left == tolerance::kPivotLeft) return within;
  }
}

// J_c -= N_c (N_c^T N_c)^+ N_c^T J_c for the columns of N in one cluster.
void remove(Workspace& work, const IslandWork& d, const KktPattern& p, const rank::DependentRows::Cluster& cluster,
            const Work& w) {
  std::vector<int> rows;  // of J, that the cluster has
  for (int m = 0; m < cluster.count; ++m) {
    const int n = w.rows.members[cluster.first + m];
    for (int k = w.rows.Np[n]; k < w.rows.Np[n + 1]; ++k) rows.push_back(p.perm[w.rows.Ni[k]] - p.nv);
  }
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), cluster.count);
  for (int m = 0; m < cluster.count; ++m) {
    const int n = w.rows.members[cluster.first + m];
    for (int k = w.rows.Np[n]; k < w.rows.Np[n + 1]; ++k)
      N(std::lower_bound(rows.begin(), rows.end(), p.perm[w.rows.Ni[k]] - p.nv) - rows.begin(), m) = w.rows.Nx[k];
  }
  for (int c = 0; c < p.nv; ++c) {
    std::vector<double*> entries;
    std::vector<Eigen::Index> in_N;
    for (const auto& [contact, j] : w.columns[c])
      for (std::size_t i = 0; i < rows.size(); ++i)
        if (w.contact[rows[i]] == contact) {
          entries.push_back(&work.contacts[d.island.contacts[contact]].J(w.row[rows[i]], j));
          in_N.push_back(static_cast<Eigen::Index>(i));
        }
    if (entries.empty()) continue;
    Eigen::VectorXd J_c(static_cast<Eigen::Index>(entries.size()));
    for (Eigen::Index i = 0; i < J_c.size(); ++i) J_c[i] = *entries[static_cast<std::size_t>(i)];
    const Eigen::MatrixXd N_c = N(in_N, Eigen::all);
    const Eigen::VectorXd left = N_c.transpose() * J_c, terms = N_c.cwiseAbs().transpose() * J_c.cwiseAbs();
    if ((left.cwiseAbs().array() <= tolerance::kNullColumn * terms.array()).all()) continue;  // depend in truth
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition(N_c.rows(), N_c.cols());
    decomposition.setThreshold(tolerance::kRank);  // columns of N that are of other rows have rounding here
    const Eigen::VectorXd part = N_c * decomposition.compute(N_c).solve(J_c);
    for (Eigen::Index i = 0; i < J_c.size(); ++i) *entries[static_cast<std::size_t>(i)] -= part[i];
  }
}

}  // namespace

double WithinTolerance::make_dependent(const Scene& scene, Workspace& work, const IslandWork& d) {
  if (!work_) work_ = std::make_unique<Work>();
  Work& w = *work_;
  take_island(scene, d, w);
  const double L = w.lever = largest_lever(work, d, w);
  const KktPattern& p = *d.shape->pattern(Order::kLeafToRoot);
  if (!find(scene, work, d, p, L, w)) return 0;
  for (const auto& cluster : w.rows.clusters) remove(work, d, p, cluster, w);
  double largest = 0;  // sum |n_j|
  for (std::size_t n = 0; n + 1 < w.rows.Np.size(); ++n)
    largest = std::max(largest, std::accumulate(w.rows.Nx.begin() + w.rows.Np[n], w.rows.Nx.begin() + w.rows.Np[n + 1],
                                                0.0, [](double sum, double x) { return sum + std::abs(x); }));
  constexpr int kFactors = 4;  // of N^T J' v: N, what J changes by, and v, which changes J and is changed
  return kFactors * largest * w.tolerance / L;
}

double WithinTolerance::inaccuracy(int coordinate) const {
  return work_->turns[coordinate] ? work_->tolerance : work_->tolerance / work_->lever;
}

bool is_inexact(const Scene& scene, const IslandWork& d) {
  return d.island.nc > 0 && (scene.tolerance > 0 || d.depended > 0);
}

}  // namespace manycontact
