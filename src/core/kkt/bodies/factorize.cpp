#include <algorithm>
#include <cmath>
#include <limits>

#include "manycontact/kkt/bodies/ldl.hpp"
#include "manycontact/sparse/decompositions.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pairs.hpp"

namespace manycontact {

void BodyLdl::resize(const BodyPattern& s) {
  P.resize(s.nodes);
  p.resize(s.nodes);
  U.resize(6, s.nv);
  u.resize(s.nv);
  g.resize(s.nc);
  Dinv.resize(s.D_first.back());
  count.resize(s.nodes);
  eliminated.resize(s.nodes);
  least_kept.resize(s.nodes);
  drops_below.resize(s.nodes);
  row_first.resize(s.nodes);
  joint_first.resize(s.nodes);
  square_first.resize(s.nodes);
  row.resize(s.row_first.back());
  G.resize(s.row_first.back());
  H.resize(s.row_first.back());
  W.resize(s.joint_first.back());
  E.resize(s.square_first.back());
  base_row.resize(s.most_at_base);
  base_E.resize(static_cast<std::size_t>(s.most_at_base) * s.most_at_base);
  hold.resize(s.own_first.size() - 1);
  for (auto* x : {&pivot_sum, &least_inertia, &most_inertia}) x->resize(s.nc);
  place.assign(s.nc, -1);
  dropped.assign(s.nc, 0);
  found.clear();
}

namespace {

using V6 = Vec6<double>;
using M6 = Mat6<double>;

// The rows open (not yet eliminated) at one node, in positions 0 ... m-1, with their entries of the arrays of BodyLdl.
struct Rows {
  int m, ld;
  int* row;
  V6 *G, *H;
  double *W, *E;  // W: m x ndof; E: m x ld, symmetric among rows not yet eliminated, with L in the other columns

  double& e(int i, int j) { return E[static_cast<std::ptrdiff_t>(i) * ld + j]; }
};

Rows rows_of(const BodyPattern& s, BodyLdl& d, int i) {
  const std::size_t first = d.row_first[i];
  return {d.count[i],
          s.most[i],
          d.row.data() + first,
          d.G.data() + first,
          d.H.data() + first,
          d.W.data() + d.joint_first[i],
          d.E.data() + d.square_first[i]};
}

// Adds to Q the inertia P shifted by r, X^T P X with X = [1, -[r]x; 0, 1]. P = [A, B; B^T, C] is symmetric, and
// X^T P X is
//   [A, B'; B'^T, C - B^T [r]x + [r]x B'],   B' = B - A [r]x
void add_shifted(const M6& P, const Vec3<double>& r, M6& Q) {
  const double x = r[0], y = r[1], z = r[2];
  const auto add = [&](int j, const V6& column) { Q.col(j) += pairs::force_from(column, r); };  // X^T (P X)
  for (int j = 0; j < 3; ++j) add(j, P.col(j));
  add(3, P.col(3) + (y * P.col(2) - z * P.col(1)));
  add(4, P.col(4) + (z * P.col(0) - x * P.col(2)));
  add(5, P.col(5) + (x * P.col(1) - y * P.col(0)));
}

void set(const Inertia<double>& Y, M6& Q) {
  using pairs::Two;
  const double m = Y.m, x = Y.h[0], y = Y.h[1], z = Y.h[2];
  const auto column = [&](int j, Two a, Two b, Two c) { Q.col(j) = pairs::joined(a, b, c); };
  column(0, Two{m, 0}, Two{0, 0}, Two{z, -y});
  column(1, Two{0, m}, Two{0, -z}, Two{0, x});
  column(2, Two{0, 0}, Two{m, y}, Two{-x, 0});
  column(3, Two{0, -z}, Two{y, Y.I(0, 0)}, Two{Y.I(1, 0), Y.I(2, 0)});
  column(4, Two{z, 0}, Two{-x, Y.I(0, 1)}, Two{Y.I(1, 1), Y.I(2, 1)});
  column(5, Two{-y, x}, Two{0, Y.I(0, 2)}, Two{Y.I(1, 2), Y.I(2, 2)});
}

// Appends row k to a node's rows, with zero entries, and returns its position there.
int open_row(Rows& at, int k, std::vector<int>& place) {
  const int n = at.m++;
  at.row[n] = k;
  at.G[n].setZero();
  for (int j = 0; j <= n; ++j) at.e(n, j) = at.e(j, n) = 0;
  return place[k] = n;
}

// Collects the rows open (not eliminated) at node i: those with an end there, and those its children did not eliminate.
void gather_rows(const BodySystem& system, BodyLdl& d, int i) {
  const BodyPattern& s = *system.pattern;
  d.count[i] = 0;
  if (s.most[i] == 0) return;
  Rows at = rows_of(s, d, i);
  for (int child = i + 1; child < s.end[i]; child = s.end[child]) {
    if (d.count[child] == d.eliminated[child]) continue;
    Rows from = rows_of(s, d, child);
    const int first = d.eliminated[child];
    for (int k = first; k < from.m; ++k) {
      const int row = from.row[k];
      if (d.dropped[row]) continue;
      const int to = d.place[row] >= 0 ? d.place[row] : open_row(at, row, d.place);
      at.G[to] += pairs::force_from(from.H[k], system.r[child]);  // G a = H X a
    }
    for (int k = first; k < from.m; ++k)
      for (int j = first; j < from.m; ++j)
        if (!d.dropped[from.row[k]] && !d.dropped[from.row[j]])
          at.e(d.place[from.row[k]], d.place[from.row[j]]) += from.e(k, j);
  }
  for (int q = s.at_first[i]; q < s.at_first[i + 1]; ++q) {
    const int row = s.at[q];
    if (d.dropped[row]) continue;
    const bool known = d.place[row] >= 0;
    const int to = known ? d.place[row] : open_row(at, row, d.place);
    if (s.A[row] == i) at.G[to] += system.GA.col(row), at.e(to, to) += system.delta;
    if (s.B[row] == i) at.G[to] += system.GB.col(row), at.e(to, to) += s.A[row] < 0 ? system.delta : 0;
  }
  for (int k = 0; k < at.m; ++k) d.place[at.row[k]] = -1;
  d.count[i] = at.m;
}

// Eliminates the joint of node i (symbols: kkt/bodies/ldl.hpp). Computes U, D^-1, P = d.P[i] - U D^-1 U^T, H = G - W
// D^-1 U^T, E += W D^-1 W^T. Returns false if D is not positive. size: the magnitudes of the terms of d.P[i].
template <int N>
bool eliminate_joint(const BodySystem& system, BodyLdl& d, int i, const V6& size, Rows& at, M6& P) {
  using Square = Eigen::Matrix<double, N, N>;
  const BodyPattern& s = *system.pattern;
  const int first = s.first_dof[i];
  const Eigen::Matrix<double, 6, N> S = system.S.middleCols<N>(first);
  const Eigen::Matrix<double, 6, N> U = d.P[i] * S;
  d.U.middleCols<N>(first) = U;
  Square D = S.transpose() * U;
  Eigen::Map<Square> Dinv(d.Dinv.data() + s.D_first[i]);
  for (int k = 0; k < N; ++k) {
    const double moved = S.col(k).cwiseAbs2().dot(size) + system.armature[first + k];
    D(k, k) += system.armature[first + k];
    if (!(D(k, k) > std::max(tolerance::kPivotLeft * moved, tolerance::kVanishing))) return false;
  }
  if constexpr (N == 1) {
    Dinv(0, 0) = 1 / D(0, 0);
  } else {
    const Eigen::LLT<Square> llt(D);
    if (llt.info() != Eigen::Success) return false;
    for (int k = 0; k < N; ++k)
      if (!(std::pow(llt.matrixLLT()(k, k), 2) > tolerance::kPivotLeft * D(k, k))) return false;
    Dinv = llt.solve(Square::Identity());
  }
  const Eigen::Matrix<double, 6, N> UD = U * Dinv;
  P.noalias() = d.P[i] - UD * U.transpose();
  P.triangularView<Eigen::StrictlyLower>() = P.transpose();  // or asymmetry would grow along thousands of links
  if (at.m == 0) return true;
  Eigen::Map<Eigen::Matrix<double, N, Eigen::Dynamic>> W(at.W, N, at.m);
  for (int k = 0; k < at.m; ++k) {
    W.col(k).noalias() = S.transpose() * at.G[k];
    at.H[k] = at.G[k] - UD * W.col(k);
  }
  for (int k = 0; k < at.m; ++k) {
    const Eigen::Matrix<double, N, 1> WD = Dinv * W.col(k);
    for (int j = 0; j < k; ++j) at.e(k, j) = at.e(j, k) += WD.dot(W.col(j));
    const double own = WD.dot(W.col(k));
    at.e(k, k) += own;
    d.pivot_sum[at.row[k]] += own;
    d.least_inertia[at.row[k]] = std::min(d.least_inertia[at.row[k]], D.diagonal().minCoeff());
    d.most_inertia[at.row[k]] = std::max(d.most_inertia[at.row[k]], D.diagonal().maxCoeff());
  }
  return true;
}

void exchange(Rows& at, int ndof, int i, int j) {
  if (i == j) return;
  std::swap(at.row[i], at.row[j]);
  std::swap(at.G[i], at.G[j]);
  std::swap(at.H[i], at.H[j]);
  for (int k = 0; k < ndof; ++k) std::swap(at.W[i * ndof + k], at.W[j * ndof + k]);
  for (int k = 0; k < at.m; ++k) std::swap(at.e(i, k), at.e(j, k));
  for (int k = 0; k < at.m; ++k) std::swap(at.e(k, i), at.e(k, j));
}

// Returns a free body's compliance along G, with P's diagonal in place of P; inverse: reciprocals of this diagonal.
double compliance(const V6& G, const V6& inverse) {
  pairs::Two sum{0, 0};
  for (int j = 0; j < 6; j += 2) {
    const pairs::Two g = pairs::load(G.data() + j), none{0, 0};
    sum +=
        g != none ? g * g * pairs::load(inverse.data() + j) : none;  // 1/0: a body without mass has infinite compliance
  }
  return sum[0] + sum[1];
}

// Returns the least sound pivot of a row relative to the terms that joints contributed. Rounding errors grow with the
// square of d.growth, the stiffening by earlier rows, and with the ratio of the joints' largest to smallest inertia. A
// small earlier pivot enlarges errors by its inverse (rank/pivots.hpp). least: the smallest earlier pivot, relative to
// its terms, at this node or, if rows were dropped, in its subtree. Others in the subtree become ever smaller in loops
// along a chain, yet are accurate, and do not count.
double least_left(const BodyLdl& d, int row, double least) {
  const double spread = d.most_inertia[row] / d.least_inertia[row];
  const double own = std::clamp(tolerance::kRowRounding * std::max(d.growth * d.growth, spread), tolerance::kPivotLeft,
                                tolerance::kMostKept);
  return std::max(own, tolerance::kRowRounding / least);
}

double least_below(const BodyLdl& d, int i) { return d.drops_below[i] ? d.least_kept[i] : 1; }

// Eliminates those complete rows (both bodies in the subtree) at node i with sound pivots, the largest first, and moves
// them to the first positions. Returns false if no remaining row has a sound pivot and they may not stay open, because
// they are too many or no joint is nearer the base.
bool eliminate_rows(const BodyPattern& s, BodyLdl& d, int i, Rows& at, M6& P) {
  const V6 inverse_P = d.P[i].diagonal().cwiseInverse();
  int done = 0;
  double least = least_below(d, i);
  while (done < at.m) {
    int best = -1, complete = 0;
    double most = -1;
    for (int k = done; k < at.m; ++k) {
      if (d.dropped[at.row[k]] || !s.complete(at.row[k], i)) continue;
      ++complete;
      const double E = at.e(k, k);
      const bool left = E > least_left(d, at.row[k], least) * d.pivot_sum[at.row[k]];
      const double ratio = left ? E / compliance(at.H[k], inverse_P) : 0;
      if (ratio > most) most = ratio, best = k;
    }
    if (best < 0) break;
    // A row waits if joints nearer the base may give it a larger pivot.
    const bool waits = most < tolerance::kRowMoves && complete <= tolerance::kMostOpen;
    if (waits && (most > 0 || s.parent[i] >= 0)) break;
    if (!(most > 0)) return false;
    d.growth = std::max(d.growth, 1 / most);
    least = std::min(least, at.e(best, best) / d.pivot_sum[at.row[best]]);
    d.least_kept[i] = std::min(d.least_kept[i], least);
    exchange(at, s.ndof[i], done, best);
    const double inverse = 1 / at.e(done, done);
    const V6 H = at.H[done];
    P.noalias() += (inverse * H) * H.transpose();
    for (int k = done + 1; k < at.m; ++k) {
      const double l = inverse * at.e(k, done);
      at.H[k] -= l * H;
      for (int j = done + 1; j <= k; ++j) at.e(k, j) = at.e(j, k) -= l * at.e(done, j);
      at.e(k, done) = l;
    }
    at.e(done, done) = inverse;
    ++done;
  }
  d.eliminated[i] = done;
  return true;
}

// Factorizes the dense E of E y = -g, for rows that no node eliminated. Returns false if a pivot is not sound.
bool eliminate_base(const BodyPattern& s, BodyLdl& d) {
  Rows at{0, s.most_at_base, d.base_row.data(), nullptr, nullptr, nullptr, d.base_E.data()};
  for (int i = 0; i < s.nodes; i = s.end[i]) {
    Rows from = rows_of(s, d, i);
    for (int k = d.eliminated[i]; k < from.m; ++k) {
      if (d.dropped[from.row[k]] || d.place[from.row[k]] >= 0) continue;
      const int n = at.m++;
      at.row[n] = from.row[k];
      d.place[from.row[k]] = n;
      for (int j = 0; j <= n; ++j) at.e(n, j) = at.e(j, n) = 0;
    }
    for (int k = d.eliminated[i]; k < from.m; ++k)
      for (int j = d.eliminated[i]; j < from.m; ++j)
        if (!d.dropped[from.row[k]] && !d.dropped[from.row[j]])
          at.e(d.place[from.row[k]], d.place[from.row[j]]) += from.e(k, j);
  }
  for (int k = 0; k < at.m; ++k) d.place[at.row[k]] = -1;
  d.base_row.resize(at.m);
  double least = 1;
  for (int i = 0; i < s.nodes; i = s.end[i]) least = std::min(least, least_below(d, i));
  for (int done = 0; done < at.m; ++done) {
    int best = done;
    double most = -1;
    for (int k = done; k < at.m; ++k)
      if (const double ratio = at.e(k, k) / d.pivot_sum[at.row[k]]; ratio > most) most = ratio, best = k;
    if (!(most > least_left(d, at.row[best], least))) return false;
    if (!d.found.empty()) least = std::min(least, most);
    std::swap(at.row[done], at.row[best]);
    for (int k = 0; k < at.m; ++k) std::swap(at.e(done, k), at.e(best, k));
    for (int k = 0; k < at.m; ++k) std::swap(at.e(k, done), at.e(k, best));
    const double inverse = 1 / at.e(done, done);
    for (int k = done + 1; k < at.m; ++k) {
      const double l = inverse * at.e(k, done);
      for (int j = done + 1; j <= k; ++j) at.e(k, j) = at.e(j, k) -= l * at.e(done, j);
      at.e(k, done) = l;
    }
    at.e(done, done) = inverse;
  }
  return true;
}

// Whether row k, not yet eliminated at node i, is a combination of the rows that constrain body i: it is in their span,
// which has the orthonormal basis `along`, and the joints below gave it no sound pivot.
template <class Q>
bool says_nothing_new(const BodyPattern& s, const BodyLdl& d, int i, Rows& at, int k, const Q& along) {
  const int row = at.row[k];
  if (!s.complete(row, i) || (s.A[row] >= 0 && s.B[row] >= 0)) return false;
  if (at.e(k, k) > least_left(d, row, least_below(d, i)) * d.pivot_sum[row]) return false;
  const V6& G = at.G[k];
  return (G - along * (along.transpose() * G).eval()).norm() <= tolerance::kRank * G.norm();
}

// At a node i that rows G = Q R constrain, replaces its children's inertia C by N C N plus the share kHeldKept of C's
// part along Q, and other rows G_j by N G_j, with N = 1 - Q Q^T (BodyHold). drop: drops rows that depend on the rows G.
void project(const BodySystem& system, BodyLdl& d, int i, bool drop, Rows& at) {
  const BodyPattern& s = *system.pattern;
  if (s.hold[i] < 0) return;
  BodyHold& h = d.hold[s.hold[i]];
  const HeldRows own = held_rows(s, d, i);
  const int m = own.count;
  if (!factorize_hold(system, i, own.row, m, h)) return;
  const auto Q = h.Q.leftCols(m);
  for (int k = 0; k < at.m; ++k) {
    if (std::find(own.row, own.row + m, at.row[k]) != own.row + m) continue;
    if (drop && says_nothing_new(s, d, i, at, k, Q)) {
      d.dropped[at.row[k]] = 1;
      d.found.push_back({at.row[k], i});
      d.drops_below[i] = 1;
    }
    if (m == 6)
      at.G[k].setZero();
    else
      at.G[k] -= Q * (Q.transpose() * at.G[k]).eval();
  }
  M6 Y;
  set(system.Y[i], Y);
  h.C = d.P[i] - Y;
  if (m == 6) {
    Y += tolerance::kHeldKept * h.C;
  } else {
    const M6 C = h.C - Q * (Q.transpose() * h.C).eval();
    Y += C - (C * Q).eval() * Q.transpose();
    Y += tolerance::kHeldKept * (Q * (Q.transpose() * h.C * Q).eval()).eval() * Q.transpose();
  }
  d.P[i] = Y;
}

V6 diagonal_of(const Inertia<double>& Y) {
  V6 out;
  out << Y.m, Y.m, Y.m, Y.I.diagonal();
  return out;
}

}  // namespace

Reason factorize_bodies(const BodySystem& system, BodyLdl& d, const BodyVectors* b, bool drop) {
  const BodyPattern& s = *system.pattern;
  if (b) d.g = b->rows;
  std::size_t row_first = 0, joint_first = 0, square_first = 0;
  d.base_row.resize(s.most_at_base);
  std::fill(d.pivot_sum.begin(), d.pivot_sum.end(), system.delta);
  std::fill(d.place.begin(), d.place.end(), -1);
  d.growth = 1;
  std::fill(d.least_inertia.begin(), d.least_inertia.end(), std::numeric_limits<double>::infinity());
  std::fill(d.most_inertia.begin(), d.most_inertia.end(), 0.0);
  std::fill(d.drops_below.begin(), d.drops_below.end(), 0);
  for (const BodyLdl::Drop& drop : d.found)
    if (drop.node < s.nodes) d.drops_below[drop.node] = 1;
  for (int i = s.nodes - 1; i >= 0; --i) {
    if (s.end[i] == i + 1) set(system.Y[i], d.P[i]);
    V6 size = diagonal_of(system.Y[i]);
    d.least_kept[i] = 1;
    for (int child = i + 1; child < s.end[i]; child = s.end[child]) {
      d.least_kept[i] = std::min(d.least_kept[i], d.least_kept[child]);
      d.drops_below[i] |= d.drops_below[child];
      const M6& C = d.P[child];
      const double lever = system.r[child].squaredNorm() * C.diagonal().head<3>().sum();
      size.head<3>() += C.diagonal().head<3>();
      size.tail<3>().array() += 2 * (C.diagonal().tail<3>().array() + lever);
    }
    d.row_first[i] = row_first, d.joint_first[i] = joint_first, d.square_first[i] = square_first;
    gather_rows(system, d, i);
    Rows at = rows_of(s, d, i);
    row_first += at.m, joint_first += static_cast<std::size_t>(at.m) * s.ndof[i];
    square_first += static_cast<std::size_t>(at.m) * s.most[i];
    project(system, d, i, drop, at);
    d.eliminated[i] = 0;
    const V6 inverse = d.P[i].diagonal().cwiseInverse();
    for (int k = 0; k < at.m; ++k)  // the terms of a row's pivot include its pivot on the body if the body were free
      if (s.A[at.row[k]] == i || s.B[at.row[k]] == i) d.pivot_sum[at.row[k]] += compliance(at.G[k], inverse);
    M6 P;
    const bool positive = s.ndof[i] == 1   ? eliminate_joint<1>(system, d, i, size, at, P)
                          : s.ndof[i] == 3 ? eliminate_joint<3>(system, d, i, size, at, P)
                                           : eliminate_joint<6>(system, d, i, size, at, P);
    if (!positive) return d.P[i].allFinite() ? Reason::kSingularInertia : Reason::kNotFinite;
    if (at.m > 0 && !eliminate_rows(s, d, i, at, P)) return P.allFinite() ? Reason::kSmallPivot : Reason::kNotFinite;
    if (b) backward_step(system, d, *b, i);
    const int parent = s.parent[i];
    if (parent < 0) continue;
    // The last child is eliminated first, and initialises the parent's P.
    if (s.end[i] == s.end[parent]) set(system.Y[parent], d.P[parent]);
    add_shifted(P, system.r[i], d.P[parent]);
  }
  return eliminate_base(s, d) ? Reason::kNone : Reason::kSmallPivot;
}

}  // namespace manycontact
