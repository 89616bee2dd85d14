#include "manycontact/detail/algorithm/rnea_derivatives.hpp"

namespace manycontact {

template <class S>
RneaDerivativesOf<S>::RneaDerivativesOf(const Model& model)
    : Psid(6, model.nv),
      Psidd(6, model.nv),
      Sv(6, model.nv),
      l(model.njoints()),
      C(model.njoints()),
      f(model.njoints()),
      dq_lower(packed_size(model)),
      dv_lower(packed_size(model)),
      dq_upper(packed_size(model)),
      dv_upper(packed_size(model)) {}

namespace {

// Computes l and C of one body, where 2B = [0, -2[l]x; 0, C] (detail/algorithm/rnea_derivatives.hpp): C = [w]I - I[w] -
// [v][h] - [h][v] - [k]. (v, w) is the body's velocity, (l, k) its momentum, h its first moment of mass.
template <class S>
void add_rates(const Inertia<S>& Y, const Vec6<S>& velocity, Vec3<S>& l, Mat3<S>& C) {
  using V3 = Vec3<S>;
  using M3 = Mat3<S>;
  const V3 v = velocity.template head<3>(), w = velocity.template tail<3>();
  l = add_cross(Y.m * v, w, Y.h);
  const V3 k = add_cross(times<S>(Y.I, w), Y.h, v);
  M3 wI;  // [w]I; [w]I - I[w] = wI + wI^T, as I is symmetric
  for (int j = 0; j < 3; ++j) wI.col(j) = cross(w, Y.I.col(j));
  const S vh2 = S(2) * dot(v, Y.h);  // [v][h] + [h][v] = h v^T + v h^T - 2 (v.h) 1
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      const S both = multiply_add(S(-v[i]), Y.h[j], multiply_add(S(-Y.h[i]), v[j], S(wI(i, j) + wI(j, i))));
      C(i, j) = C(j, i) = both;
    }
    C(i, i) += vh2;
  }
  C -= skew<S>(k);
}

template <class S>
void forward(const Model& model, const Kinematics<S>& kin, const std::vector<Vec6<S>>& fext, RneaDerivativesOf<S>& d,
             const Vec6<S>& base) {
  using V6 = Vec6<S>;
  const V6 zero = V6::Zero();
  for (int i = 0; i < model.njoints(); ++i) {
    const Joint& joint = model.joints[i];
    const V6& vp = joint.parent < 0 ? zero : kin.v[joint.parent];
    const V6& ap = joint.parent < 0 ? base : kin.a[joint.parent];
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
      const V6 s = kin.J.col(k);
      const V6 Psid = cross_motion(vp, s);
      d.Psid.col(k) = Psid;
      d.Psidd.col(k) = add_cross_motion(cross_motion(ap, s), vp, Psid);
      d.Sv.col(k) = add_cross_motion(Psid, kin.v[i], s);
    }
    add_rates(kin.Y[i], kin.v[i], d.l[i], d.C[i]);
    d.f[i] = add_cross_force(kin.Y[i] * kin.a[i], kin.v[i], kin.Y[i] * kin.v[i]);
    if (!fext.empty()) d.f[i] -= fext[i];
  }
}

// Computes the entries of dtau/dq and dtau/dv for each coordinate k of joint i, paired with k and with its ancestors.
template <class S>
void fill(const Model& model, const Kinematics<S>& kin, const Inertia<S>& Yc, int i, RneaDerivativesOf<S>& d) {
  using V3 = Vec3<S>;
  using V6 = Vec6<S>;
  const V3 l2 = S(2) * d.l[i];
  const Joint& joint = model.joints[i];
  for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
    const V6 s = kin.J.col(k), Psid = d.Psid.col(k);
    const V6 Ys = Yc * s;
    // 2B^T s = [0; Bs]
    const V3 Bs = add_cross(transpose_times<S>(d.C[i], s.template tail<3>()), l2, s.template head<3>());
    V6 Fq = Yc * d.Psidd.col(k), Fv = Yc * d.Sv.col(k);
    const auto add_rate = [&](const auto& m, V6& F) {  // F += 2B m
      F.template head<3>() = add_cross(F.template head<3>(), m.template tail<3>(), l2);
      F.template tail<3>() = add_times<S>(F.template tail<3>(), d.C[i], m.template tail<3>());
    };
    add_rate(Psid, Fq);
    add_rate(s, Fv);
    int at = model.M_begin[k];
    const auto entry = [&](int j) {
      d.dq_lower[at] = add_dot(dot(Ys, d.Psidd.col(j)), Bs, d.Psid.col(j).template tail<3>());
      d.dv_lower[at] = add_dot(dot(Ys, d.Sv.col(j)), Bs, kin.J.col(j).template tail<3>());
      d.dq_upper[at] = dot(Fq, kin.J.col(j));
      d.dv_upper[at] = dot(Fv, kin.J.col(j));
      ++at;
    };
    int j = k;
    for (; j >= joint.idx_v; --j) entry(j);  // coordinates of joint i: without S x* f, as S and f rotate together
    Fq += cross_force(s, d.f[i]);
    for (j = model.dof_parent[joint.idx_v]; j >= 0; j = model.dof_parent[j]) entry(j);
  }
}

}  // namespace

template <class S>
void rnea_derivatives(const Model& model, const Kinematics<S>& kin, const std::vector<Inertia<S>>& Yc,
                      const std::vector<Vec6<S>>& fext, RneaDerivativesOf<S>& d) {
  forward<S>(model, kin, fext, d, kin.a_base);
  for (int i = model.njoints() - 1; i >= 0; --i) {
    fill<S>(model, kin, Yc[i], i, d);
    const int parent = model.joints[i].parent;
    if (parent < 0) continue;
    d.l[parent] += d.l[i];
    d.C[parent] += d.C[i];
    d.f[parent] += d.f[i];
  }
}

using Real = InstantiatedScalar;
template struct RneaDerivativesOf<Real>;
template void rnea_derivatives<Real>(const Model&, const Kinematics<Real>&, const std::vector<Inertia<Real>>&,
                                     const std::vector<Vec6<Real>>&, RneaDerivativesOf<Real>&);

}  // namespace manycontact
