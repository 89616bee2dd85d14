#include "manycontact/kkt/bodies/ldl.hpp"

namespace manycontact {

namespace {

using V6 = Vec6<double>;

// From the leaves: what the right-hand sides leave for a node's parent, p and g.
template <int N>
V6 lift(const BodySystem& system, BodyLdl& d, const BodyVectors& b, int i) {
  const BodyPattern& s = *system.pattern;
  const int first = s.first_dof[i];
  const V6& c = b.motion[i];
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
  const std::size_t at = s.row_first[i];
  const Eigen::Map<const Eigen::Matrix<double, N, Eigen::Dynamic>> W(d.W.data() + s.joint_first[i], N, m);
  for (int k = 0; k < m; ++k) d.g[d.row[at + k]] -= d.G[at + k].dot(c) + W.col(k).dot(Du);
  for (int k = 0; k < d.gone[i]; ++k) {
    const double* L = d.E.data() + s.square_first[i] + k;  // column k
    const double g = d.g[d.row[at + k]];
    p -= d.H[at + k] * (g * L[static_cast<std::ptrdiff_t>(k) * s.most[i]]);
    for (int j = k + 1; j < m; ++j) d.g[d.row[at + j]] -= L[static_cast<std::ptrdiff_t>(j) * s.most[i]] * g;
  }
  return p;
}

// From the bases: y of the rows eliminated at a node, qdd, a, f. a: of the parent, about the node's origin.
template <int N>
void drop(const BodySystem& system, const BodyLdl& d, const BodyVectors& b, int i, const V6& a, BodyVectors& x) {
  const BodyPattern& s = *system.pattern;
  const int first = s.first_dof[i], m = d.count[i];
  const std::size_t at = s.row_first[i];
  for (int k = d.gone[i] - 1; k >= 0; --k) {
    const double* L = d.E.data() + s.square_first[i] + k;
    double y = (d.H[at + k].dot(a) - d.g[d.row[at + k]]) * L[static_cast<std::ptrdiff_t>(k) * s.most[i]];
    for (int j = k + 1; j < m; ++j) y -= L[static_cast<std::ptrdiff_t>(j) * s.most[i]] * x.rows[d.row[at + j]];
    x.rows[d.row[at + k]] = y;
  }
  Eigen::Matrix<double, N, 1> w = d.U.middleCols<N>(first).transpose() * a;
  const Eigen::Map<const Eigen::Matrix<double, N, Eigen::Dynamic>> W(d.W.data() + s.joint_first[i], N, m);
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

}  // namespace

void solve_bodies(const BodySystem& system, BodyLdl& d, const BodyVectors& b, BodyVectors& x) {
  const BodyPattern& s = *system.pattern;
  d.g = b.rows;
  for (int i = s.nodes - 1; i >= 0; --i) {
    if (s.end[i] == i + 1) d.p[i] = b.force[i];
    const V6 p = s.ndof[i] == 1   ? lift<1>(system, d, b, i)
                 : s.ndof[i] == 3 ? lift<3>(system, d, b, i)
                                  : lift<6>(system, d, b, i);
    const int parent = s.parent[i];
    if (parent < 0) continue;
    if (s.end[i] == s.end[parent])
      d.p[parent] = b.force[parent] + force_from(p, system.r[i]);
    else
      d.p[parent] += force_from(p, system.r[i]);
  }
  const int m = static_cast<int>(d.base_row.size());
  const auto L = [&](int i, int j) { return d.base_E[static_cast<std::size_t>(i) * s.most_at_base + j]; };
  for (int k = 0; k < m; ++k)
    for (int j = k + 1; j < m; ++j) d.g[d.base_row[j]] -= L(j, k) * d.g[d.base_row[k]];
  for (int k = m - 1; k >= 0; --k) {
    double y = -d.g[d.base_row[k]] * L(k, k);
    for (int j = k + 1; j < m; ++j) y -= L(j, k) * x.rows[d.base_row[j]];
    x.rows[d.base_row[k]] = y;
  }
  for (int i = 0; i < s.nodes; ++i) {
    const V6 a = s.parent[i] < 0 ? V6(V6::Zero()) : motion_at(x.motion[s.parent[i]], system.r[i]);
    if (s.ndof[i] == 1)
      drop<1>(system, d, b, i, a, x);
    else if (s.ndof[i] == 3)
      drop<3>(system, d, b, i, a, x);
    else
      drop<6>(system, d, b, i, a, x);
  }
}

}  // namespace manycontact
