#include "manycontact/kkt/bodies/dependent_rows.hpp"

#include <algorithm>
#include <cmath>

#include "manycontact/sparse/decompositions.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pairs.hpp"

namespace manycontact {

namespace {

using V6 = Vec6<double>;

using Basis = BodyDependence::Basis;

void add(V6 S, Basis& basis) {
  const double length = S.norm();
  for (int pass = 0; pass < 2; ++pass)
    for (int k = 0; k < basis.rank; ++k) S -= basis.Q.col(k) * basis.Q.col(k).dot(S);
  if (basis.rank < 6 && S.norm() > tolerance::kRank * length) basis.Q.col(basis.rank++) = S.normalized();
}

// Computes, for each body, an orthonormal basis of the motions about its origin that the joints above it allow.
void find_bases(const BodySystem& s, std::vector<Basis>& bases) {
  const BodyPattern& p = *s.pattern;
  bases.resize(p.nodes);
  for (int i = 0; i < p.nodes; ++i) {
    bases[i].rank = 0;
    for (int k = p.first_dof[i]; k < p.first_dof[i] + p.ndof[i]; ++k) add(s.S.col(k), bases[i]);
    if (p.parent[i] < 0) continue;
    const Basis& above = bases[p.parent[i]];
    for (int k = 0; k < above.rank; ++k) add(pairs::motion_at(above.Q.col(k), s.r[i]), bases[i]);
  }
}

// Returns the norm of a force F's projection onto the body's motions, relative to |F|; zero if F drives no joint.
double moved_by(const V6& F, const Basis& basis) {
  double sum = 0;
  for (int k = 0; k < basis.rank; ++k) sum += std::pow(basis.Q.col(k).dot(F), 2);
  return std::sqrt(sum) / F.norm();
}

// Calls use(row) for each row whose entries in J are rounding errors, until use returns false. s.delta > 0: no calls.
template <class Use>
void each_vanishing_row(const BodySystem& s, std::vector<Basis>& bases, Use&& use) {
  const BodyPattern& p = *s.pattern;
  bool known = false;  // whether `bases` are computed
  // Whether a force G on a node drives any coordinate. Visits joints from the node to the base until an entry of J is
  // certainly nonzero. After kManyJoints joints, compares the force with the basis of the body's motions.
  const auto moves = [&](int node, V6 G) {
    double largest = 0, size = 0;
    V6 sizes = G.cwiseAbs();
    for (int met = 0; node >= 0; ++met) {
      for (int k = p.first_dof[node]; k < p.first_dof[node] + p.ndof[node]; ++k) {
        largest = std::max(largest, std::abs(G.dot(s.S.col(k))));
        size = std::max(size, sizes.dot(s.S.col(k).cwiseAbs()));
        if (largest > tolerance::kPlainlyMoves * size) return true;
      }
      if (met >= tolerance::kManyJoints) {
        if (!known) find_bases(s, bases), known = true;
        return largest > tolerance::kRank * size || moved_by(G, bases[node]) > tolerance::kRank;
      }
      sizes.tail<3>() += cross_sizes<double>(s.r[node].cwiseAbs(), sizes.head<3>());
      G = pairs::force_from(G, s.r[node]);
      node = p.parent[node];
    }
    return largest > tolerance::kRank * size;
  };
  for (int k = 0; s.delta == 0 && k < p.nc; ++k)
    if (!moves(p.A[k], s.GA.col(k)) && !moves(p.B[k], s.GB.col(k)) && !use(k)) return;
}

// Whether one end of a row is immovable, i.e. in the world or on a fixed base.
bool stands(const BodyPattern& p, int row) { return p.A[row] < 0 || p.B[row] < 0; }

// Computes row coefficients whose forces balance: they cause no torque at the joints between the rows' bodies, and add
// up to zero at the last body. The equations are reduced to triangular form whenever their memory is full.
class Balance {
 public:
  Balance(const BodySystem& system, int row) : s_(system), node_(std::max(s_.pattern->A[row], s_.pattern->B[row])) {
    (void)add(row);
  }

  int node() const { return node_; }
  bool add(int row) {  // false: too many rows
    if (count_ == kRows) return false;
    row_[count_] = row;
    F_[count_++] = s_.pattern->A[row] == node_ ? s_.GA.col(row) : s_.GB.col(row);
    return true;
  }
  /// Adds the balance equations of the current node's joint. The node's parent then becomes the current node.
  void pass() {
    const BodyPattern& p = *s_.pattern;
    for (int k = p.first_dof[node_]; k < p.first_dof[node_] + p.ndof[node_]; ++k)
      balance([&](const V6& F) { return s_.S.col(k).dot(F); });
    for (int k = 0; k < count_; ++k) F_[k] = pairs::force_from(F_[k], s_.r[node_]);
    node_ = p.parent[node_];
  }
  /// Solves for the row coefficients, 1 for the first row, and calls put(row, coefficient) for each. Returns false if
  /// the forces cannot balance.
  template <class Put>
  bool solve(Put&& put) {
    for (int k = 0; k < 6; ++k) balance([&](const V6& F) { return F[k]; });
    const Matrix A = A_.topLeftCorner(equations_, count_);
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kRows, 1> y(count_);
    y[0] = 1;
    if (count_ > 1) {
      const Matrix others = A.rightCols(count_ - 1);
      y.tail(count_ - 1) = Eigen::ColPivHouseholderQR<Matrix>(others).solve(-A.col(0));
    }
    const double size = largest_ * y.cwiseAbs().maxCoeff();
    if (!((A * y).cwiseAbs().maxCoeff() <= tolerance::kRank * size)) return false;
    for (int k = 0; k < count_; ++k)
      if (std::abs(y[k]) > tolerance::kNullEntry) put(row_[k], y[k]);
    return true;
  }

 private:
  static constexpr int kRows = tolerance::kBalancedRows, kEquations = tolerance::kBalanceEquations;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kEquations, kRows>;

  template <class Of>
  void balance(Of&& of) {
    if (equations_ == kEquations) {
      const Eigen::HouseholderQR<Matrix> qr(A_.leftCols(count_));
      A_.leftCols(count_) = qr.matrixQR().template triangularView<Eigen::Upper>();
      equations_ = count_;
    }
    A_.row(equations_).setZero();  // contact rows that are added later have no entry in this equation
    for (int k = 0; k < count_; ++k) {
      A_(equations_, k) = of(F_[k]);
      largest_ = std::max(largest_, std::abs(A_(equations_, k)));
    }
    ++equations_;
  }

  const BodySystem& s_;
  int node_, count_ = 0, equations_ = 0;
  int row_[kRows];
  V6 F_[kRows];  // wrenches of the rows about the origin of node_'s body
  Eigen::Matrix<double, kEquations, kRows> A_ = Eigen::Matrix<double, kEquations, kRows>::Zero();
  double largest_ = 0;
};

// Computes a dropped row's column of J^T's null space, from rows with an immovable end on the bodies from its own node
// to drop.node, not dropped at drop.node or earlier. Returns false if these do not balance the row.
template <class Put>
bool null_column(const BodySystem& s, const BodyLdl::Drop& drop, const std::vector<int>& dropped_at, Put&& put) {
  const BodyPattern& p = *s.pattern;
  Balance balance(s, drop.row);
  const auto add_rows = [&] {
    const int node = balance.node();
    for (int q = p.at_first[node]; q < p.at_first[node + 1]; ++q)
      if (stands(p, p.at[q]) && dropped_at[p.at[q]] < drop.node && !balance.add(p.at[q])) return false;
    return true;
  };
  while (add_rows()) {
    if (balance.node() == drop.node) return balance.solve(put);
    balance.pass();
  }
  return false;
}

// Computes a basis of J^T's null space: a column per dropped row, the last first, with no entry in rows dropped later.
bool find_null_space(const BodySystem& s, const BodyLdl& d, BodyDependence& work) {
  const BodyPattern& p = *s.pattern;
  rank::DependentRows& rows = work.rows;
  std::vector<int>&dropped_at = work.dropped_at, &column = work.column, &entries = work.entries;
  std::vector<double>& x = work.x;
  dropped_at.assign(p.nc, -1);
  column.assign(p.nc, -1);
  x.assign(p.nc, 0);
  entries.clear();
  for (const BodyLdl::Drop& drop : d.found) dropped_at[drop.row] = drop.node;
  rows.dropped.clear();
  rows.turned.clear();
  rows.Np.assign(1, 0);
  rows.Ni.clear();
  rows.Nx.clear();
  const auto add = [&](int row, double value) {
    if (x[row] == 0) entries.push_back(row);
    x[row] += value;
  };
  for (std::size_t k = d.found.size(); k-- > 0;) {
    const BodyLdl::Drop& drop = d.found[k];
    const auto put = [&](int row, double value) {
      if (row == drop.row || column[row] < 0) return add(row, value);
      for (int q = rows.Np[column[row]] + 1; q < rows.Np[column[row] + 1]; ++q) add(rows.Ni[q], -value * rows.Nx[q]);
    };
    if (drop.node == p.nodes)  // the row moves no coordinate
      put(drop.row, 1.0);
    else if (!null_column(s, drop, dropped_at, put))
      return false;
    column[drop.row] = static_cast<int>(rows.dropped.size());
    rows.dropped.push_back(drop.row);
    for (int row : entries) {  // the dropped row's own entry is the first
      if (std::abs(x[row]) > tolerance::kNullEntry) rows.Ni.push_back(row), rows.Nx.push_back(x[row]);
      x[row] = 0;
    }
    entries.clear();
    rows.Np.push_back(static_cast<int>(rows.Ni.size()));
  }
  rank::make_projector(p.nc, rows);
  return rows.largest_entry <= tolerance::kLargestEntry;
}

// Sets x.motion to the bodies' accelerations for b.motion and qdd = 0, and subtracts those along the rows from x.rows.
void take_away(const BodySystem& s, const BodyVectors& b, BodyVectors& x) {
  const BodyPattern& p = *s.pattern;
  for (int i = 0; i < p.nodes; ++i) {
    x.motion[i] = b.motion[i];
    if (p.parent[i] >= 0) x.motion[i] += pairs::motion_at(x.motion[p.parent[i]], s.r[i]);
    for (int q = p.at_first[i]; q < p.at_first[i + 1]; ++q)
      x.rows[p.at[q]] -= (p.A[p.at[q]] == i ? s.GA : s.GB).col(p.at[q]).dot(x.motion[i]);
  }
}

// Computes x.force, the joints' forces on bodies, from the accelerations and contact forces in x.
void balance_bodies(const BodySystem& s, const BodyVectors& b, BodyVectors& x) {
  const BodyPattern& p = *s.pattern;
  for (int i = 0; i < p.nodes; ++i) {
    x.force[i] = b.force[i] + pairs::times(s.Y[i], x.motion[i]);
    for (int q = p.at_first[i]; q < p.at_first[i + 1]; ++q)
      x.force[i] += (p.A[p.at[q]] == i ? s.GA : s.GB).col(p.at[q]) * x.rows[p.at[q]];
  }
  for (int i = p.nodes - 1; i >= 0; --i)
    if (p.parent[i] >= 0) x.force[p.parent[i]] += pairs::force_from(x.force[i], s.r[i]);
}

// Lists in `rows` those rows between node i and immovable bodies that the others span. The others are chosen one by
// one, each with the largest part that is independent of those chosen before.
void find_rows_others_say(const BodySystem& s, const BodyLdl& d, int i, std::vector<BodyDependence::OnBody>& rows) {
  const BodyPattern& p = *s.pattern;
  const auto share = [](const BodyDependence::OnBody& r) { return r.F.norm() / r.length; };
  rows.clear();
  for (int q = p.at_first[i]; q < p.at_first[i + 1]; ++q) {
    const int row = p.at[q];
    if (!stands(p, row) || d.dropped[row]) continue;
    const V6 F = p.A[row] == i ? s.GA.col(row) : s.GB.col(row);
    rows.push_back({row, F, F.norm()});
  }
  while (!rows.empty()) {
    const auto best =
        std::max_element(rows.begin(), rows.end(), [&](const auto& a, const auto& b) { return share(a) < share(b); });
    if (!(share(*best) > tolerance::kRank)) break;
    const V6 direction = best->F.normalized();
    std::swap(*best, rows.back());
    rows.pop_back();
    for (BodyDependence::OnBody& r : rows) r.F -= direction * direction.dot(r.F);
  }
}

void drop_rows_of_one_body(const BodySystem& s, BodyLdl& d, std::vector<BodyDependence::OnBody>& rows) {
  for (int i = s.pattern->nodes - 1; i >= 0; --i) {
    find_rows_others_say(s, d, i, rows);
    std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
    for (const BodyDependence::OnBody& r : rows) d.dropped[r.row] = 1, d.found.push_back({r.row, i});
  }
}

}  // namespace

bool has_vanishing_row(const BodySystem& s, BodyDependence& work) {
  bool any = false;
  each_vanishing_row(s, work.bases, [&](int) { return any = true, false; });
  return any;
}

void forget_dropped(BodyLdl& d) {
  for (const BodyLdl::Drop& drop : d.found) d.dropped[drop.row] = 0;
  d.found.clear();
}

Reason factorize_dependent(const BodySystem& system, BodyLdl& d, BodyDependence& work) {
  forget_dropped(d);
  each_vanishing_row(system, work.bases, [&](int row) {
    d.dropped[row] = 1;
    d.found.push_back({row, system.pattern->nodes});
    return true;
  });
  drop_rows_of_one_body(system, d, work.on_body);
  if (const Reason reason = factorize_bodies(system, d, nullptr, true); reason != Reason::kNone) return reason;
  const int kept = system.pattern->nc - static_cast<int>(d.found.size());
  if (d.found.empty() || kept > system.pattern->nv || !find_null_space(system, d, work)) return Reason::kSmallPivot;
  return factorize_bodies(system, d);  // bodies have fewer rows now, which changes their projections (BodyHold)
}

sparse::Refinement solve_dependent(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps,
                                   BodyDependence& work) {
  v.dx.rows = v.b.rows;
  take_away(system, v.b, v.dx);
  work.null_component.setZero(system.pattern->nc);
  rank::project_out(work.rows, v.dx.rows.data(), work.null_component.data());
  v.b.rows -= work.null_component;
  (void)solve_refined(system, ldl, v, max_steps);
  rank::project_out(work.rows, v.x.rows.data());
  balance_bodies(system, v.b, v.x);
  // The bodies' forces were computed again, from the projected y, so that the backward error has other rounding errors.
  double error = backward_error(system, v.b, v.x, v.residual);
  return sparse::refine(
      max_steps, tolerance::kRefined, [&] { return error; },
      [&] {
        backward_sweep(system, ldl, v.residual.r);
        (void)correct_bodies(system, ldl, v.b, v.dx, v.x, v.residual);
        error = backward_error(system, v.b, v.x, v.residual);
      });
}

std::pair<double, double> row_terms_of_joints(const BodySystem& s, BodySolve& v) {
  const BodyPattern& p = *s.pattern;
  v.dx.rows = v.b.rows;
  take_away(s, v.b, v.dx);
  // size[i] bounds the terms of a body's acceleration without cancellation: |X| times the parent's size plus |S| |qdd|.
  auto& size = v.dx.motion;
  for (int i = 0; i < p.nodes; ++i) {
    size[i].setZero();
    if (p.parent[i] >= 0) {
      size[i] = size[p.parent[i]];
      size[i].head<3>() += cross_sizes<double>(size[i].tail<3>(), s.r[i].cwiseAbs());
    }
    for (int k = p.first_dof[i]; k < p.first_dof[i] + p.ndof[i]; ++k)
      size[i] += s.S.col(k).cwiseAbs() * std::abs(v.x.joints[k]);
  }
  double Ja = 0;
  for (int k = 0; k < p.nc; ++k) {
    double sum = 0;
    if (p.A[k] >= 0) sum += s.GA.col(k).cwiseAbs().dot(size[p.A[k]]);
    if (p.B[k] >= 0) sum += s.GB.col(k).cwiseAbs().dot(size[p.B[k]]);
    Ja = std::max(Ja, sum);
  }
  return {Ja, v.dx.rows.cwiseAbs().maxCoeff()};
}

}  // namespace manycontact
