#include "manycontact/kkt/bodies/ldl.hpp"
#include "pairs.hpp"

namespace manycontact {

namespace {

using V6 = Vec6<double>;

// Adds to the bias force p, and to the right-hand sides g_j of rows not yet eliminated at node i, the effect of a_g,
// the acceleration that the node's constraint rows prescribe. Then projects p (BodyHold).
void backward_hold(const BodySystem& system, BodyLdl& d, const BodyVectors& b, int i) {
  const BodyPattern& s = *system.pattern;
  const BodyHold& h = d.hold[s.hold[i]];
  if (h.rows == 0) return;
  const HeldRows own = held_rows(s, d, i);
  const auto Q = h.Q.leftCols(h.rows);
  V6 w;
  for (int k = 0; k < h.rows; ++k) w[k] = d.g[own.row[k]];
  const V6 a = Q * solve_transposed(h, w).head(h.rows);
  for (int child = i + 1; child < s.end[i]; child = s.end[child]) {
    const V6 at_child = pairs::motion_at(a, system.r[child]);
    const std::size_t at = d.row_first[child];
    for (int k = d.eliminated[child]; k < d.count[child]; ++k) d.g[d.row[at + k]] -= d.H[at + k].dot(at_child);
  }
  for (int q = s.at_first[i]; q < s.at_first[i + 1]; ++q) {
    const int row = s.at[q];
    if (s.A[row] < 0 || s.B[row] < 0) continue;
    if (s.A[row] == i) d.g[row] -= a.dot(system.GA.col(row));
    if (s.B[row] == i) d.g[row] -= a.dot(system.GB.col(row));
  }
  if (h.rows < 6) {
    const V6 p = d.p[i] - b.force[i] + h.C * a;
    d.p[i] = b.force[i] + p - Q * (Q.transpose() * p).eval();
  } else {
    d.p[i] = b.force[i];
  }
}

// Eliminates the joint and rows of node i from the right-hand sides, updates g of rows that remain, and returns the
// bias force p that the parent gets.
template <int N>
V6 backward(const BodySystem& system, BodyLdl& d, const BodyVectors& b, int i) {
  const BodyPattern& s = *system.pattern;
  const int first = s.first_dof[i];
  const V6& c = b.motion[i];
  if (s.hold[i] >= 0) backward_hold(system, d, b, i);
  V6 p = d.p[i];
  p.noalias() += d.P[i] * c;
  Eigen::Matrix<double, N, 1> u = b.joints.segment<N>(first);
  u.noalias() -= system.S.middleCols<N>(first).transpose() * p;
  const Eigen::Matrix<double, N, 1> Du =
      Eigen::Map<const Eigen::Matrix<double, N, N>>(d.Dinv.data() + s.D_first[i]) * u;
  d.u.segment<N>(first) = Du;
  p.noalias() += d.U.middleCols<N>(first) * Du;
  const int m = d.count[i];
  if (m == 0) return p;
  const std::size_t at = d.row_first[i];
  const Eigen::Map<const Eigen::Matrix<double, N, Eigen::Dynamic>> W(d.W.data() + d.joint_first[i], N, m);
  for (int k = 0; k < m; ++k) d.g[d.row[at + k]] -= d.G[at + k].dot(c) + W.col(k).dot(Du);
  for (int k = 0; k < d.eliminated[i]; ++k) {
    const double* L = d.E.data() + d.square_first[i] + k;  // column k of L
    const double g = d.g[d.row[at + k]];
    p -= d.H[at + k] * (g * L[static_cast<std::ptrdiff_t>(k) * s.most[i]]);
    for (int j = k + 1; j < m; ++j) d.g[d.row[at + j]] -= L[static_cast<std::ptrdiff_t>(j) * s.most[i]] * g;
  }
  return p;
}

// Performs one step of the sweep from the root to the leaves: computes y of the rows eliminated at node i, and its qdd,
// acceleration and joint force. a: the parent's acceleration, about node i's origin.
template <int N>
void forward(const BodySystem& system, const BodyLdl& d, const BodyVectors& b, int i, const V6& a, BodyVectors& x) {
  const BodyPattern& s = *system.pattern;
  const int first = s.first_dof[i], m = d.count[i];
  const std::size_t at = d.row_first[i];
  for (int k = d.eliminated[i] - 1; k >= 0; --k) {
    const double* L = d.E.data() + d.square_first[i] + k;
    double y = (d.H[at + k].dot(a) - d.g[d.row[at + k]]) * L[static_cast<std::ptrdiff_t>(k) * s.most[i]];
    for (int j = k + 1; j < m; ++j) y -= L[static_cast<std::ptrdiff_t>(j) * s.most[i]] * x.rows[d.row[at + j]];
    x.rows[d.row[at + k]] = y;
  }
  Eigen::Matrix<double, N, 1> w = d.U.middleCols<N>(first).transpose() * a;
  const Eigen::Map<const Eigen::Matrix<double, N, Eigen::Dynamic>> W(d.W.data() + d.joint_first[i], N, m);
  for (int k = 0; k < m; ++k) w += W.col(k) * x.rows[d.row[at + k]];
  const Eigen::Matrix<double, N, 1> qdd =
      d.u.segment<N>(first) - Eigen::Map<const Eigen::Matrix<double, N, N>>(d.Dinv.data() + s.D_first[i]) * w;
  x.joints.segment<N>(first) = qdd;
  x.motion[i] = a + b.motion[i];
  x.motion[i].noalias() += system.S.middleCols<N>(first) * qdd;
  V6& f = x.force[i];
  f = d.p[i];
  f.noalias() += d.P[i] * x.motion[i];
  for (int k = 0; k < m; ++k) f += d.G[at + k] * x.rows[d.row[at + k]];
}

// Computes y of the rows that constrain node i (BodyHold), from the force equation of its body.
void balance(const BodySystem& system, const BodyLdl& d, const BodyVectors& b, int i, BodyVectors& x) {
  const BodyPattern& s = *system.pattern;
  const BodyHold& h = d.hold[s.hold[i]];
  if (h.rows == 0) return;
  const HeldRows own = held_rows(s, d, i);
  V6 f = x.force[i] - b.force[i] - pairs::times(system.Y[i], x.motion[i]);
  for (int child = i + 1; child < s.end[i]; child = s.end[child])
    f -= pairs::force_from(x.force[child], system.r[child]);
  for (int q = s.at_first[i]; q < s.at_first[i + 1]; ++q) {
    const int row = s.at[q];
    if (s.A[row] < 0 || s.B[row] < 0) continue;
    f -= (s.A[row] == i ? system.GA.col(row) : system.GB.col(row)) * x.rows[row];
  }
  const V6 y = forces_of(h, f);
  for (int k = 0; k < h.rows; ++k) x.rows[own.row[k]] = y[k];
}

// Computes y of the rows that no node eliminated, by their dense factor, and sets y of dropped rows to zero.
void solve_base(BodyLdl& d, int most, BodyVectors& x) {
  for (const BodyLdl::Drop& drop : d.found) x.rows[drop.row] = 0;
  const int m = static_cast<int>(d.base_row.size());
  const auto L = [&](int i, int j) { return d.base_E[static_cast<std::size_t>(i) * most + j]; };
  for (int k = 0; k < m; ++k)
    for (int j = k + 1; j < m; ++j) d.g[d.base_row[j]] -= L(j, k) * d.g[d.base_row[k]];
  for (int k = m - 1; k >= 0; --k) {
    double y = -d.g[d.base_row[k]] * L(k, k);
    for (int j = k + 1; j < m; ++j) y -= L(j, k) * x.rows[d.base_row[j]];
    x.rows[d.base_row[k]] = y;
  }
}

// Computes the solution x, after the backward sweep. Calls dropped(i) when a, f and qdd of node i are known, and
// closed(i) when f of its children and y of its rows are known, too.
template <class Dropped, class Closed>
void forward_steps(const BodySystem& system, BodyLdl& d, const BodyVectors& b, BodyVectors& x, Dropped&& dropped,
                   Closed&& closed) {
  const BodyPattern& s = *system.pattern;
  solve_base(d, s.most_at_base, x);
  const auto close = [&](int i) {
    if (s.hold[i] >= 0) balance(system, d, b, i, x);
    closed(i);
  };
  for (int i = 0; i < s.nodes; ++i) {
    const int parent = s.parent[i];
    const V6 a = parent < 0 ? V6(V6::Zero()) : pairs::motion_at(x.motion[parent], system.r[i]);
    if (s.ndof[i] == 1)
      forward<1>(system, d, b, i, a, x);
    else if (s.ndof[i] == 3)
      forward<3>(system, d, b, i, a, x);
    else
      forward<6>(system, d, b, i, a, x);
    dropped(i);
    if (parent >= 0 && s.end[i] == s.end[parent]) close(parent);  // i is the parent's last child
    if (s.end[i] == i + 1) close(i);
  }
}

}  // namespace

void backward_step(const BodySystem& system, BodyLdl& d, const BodyVectors& b, int i) {
  const BodyPattern& s = *system.pattern;
  if (s.end[i] == i + 1) d.p[i] = b.force[i];
  const V6 p = s.ndof[i] == 1   ? backward<1>(system, d, b, i)
               : s.ndof[i] == 3 ? backward<3>(system, d, b, i)
                                : backward<6>(system, d, b, i);
  const int parent = s.parent[i];
  if (parent < 0) return;
  if (s.end[i] == s.end[parent])
    d.p[parent] = b.force[parent] + pairs::force_from(p, system.r[i]);
  else
    d.p[parent] += pairs::force_from(p, system.r[i]);
}

void backward_sweep(const BodySystem& system, BodyLdl& d, const BodyVectors& b) {
  d.g = b.rows;
  for (int i = system.pattern->nodes - 1; i >= 0; --i) backward_step(system, d, b, i);
}

double forward_sweep(const BodySystem& system, BodyLdl& d, const BodyVectors& b, BodyVectors& x, BodyResidual& left) {
  BodyJudge judge(system, b, x, left);
  forward_steps(
      system, d, b, x, [](int) {}, [&](int i) { judge.node(i); });
  judge.rows();
  return judge.error();
}

double correct_bodies(const BodySystem& system, BodyLdl& d, const BodyVectors& b, BodyVectors& dx, BodyVectors& x,
                      BodyResidual& left) {
  const BodyPattern& s = *system.pattern;
  BodyJudge judge(system, b, x, left);
  const auto add = [&](int i) {
    pairs::add(dx.motion[i], x.motion[i]);
    pairs::add(dx.force[i], x.force[i]);
    for (int k = s.first_dof[i]; k < s.first_dof[i] + s.ndof[i]; ++k) x.joints[k] += dx.joints[k];
  };
  forward_steps(system, d, left.r, dx, add, [&](int i) { judge.node(i, dx.rows.data()); });
  x.rows += dx.rows;
  judge.rows();
  return judge.error();
}

void solve_bodies(const BodySystem& system, BodyLdl& d, const BodyVectors& b, BodyVectors& x) {
  backward_sweep(system, d, b);
  forward_steps(
      system, d, b, x, [](int) {}, [](int) {});
}

}  // namespace manycontact
