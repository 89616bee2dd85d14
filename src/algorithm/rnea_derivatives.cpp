#include "manycontact/algorithm/rnea_derivatives.hpp"

namespace manycontact {

RneaDerivatives::RneaDerivatives(const Model& model)
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

using V3 = Vec3<double>;
using V6 = Vec6<double>;
using M3 = Mat3<double>;

// l and C of one body: 2B = [0, -2[l]x; 0, C], C = [w]I - I[w] - [v][h] - [h][v] - [k], with (l, k) = Y v.
void add_rates(const Inertia<double>& Y, const V6& velocity, V3& l, M3& C) {
  const V3 v = velocity.head<3>(), w = velocity.tail<3>();
  l = Y.m * v + w.cross(Y.h);
  const V3 k = Y.I * w + Y.h.cross(v);
  const M3 wI = skew<double>(w) * Y.I;
  C = wI + wI.transpose();                         // [w]I - I[w], as I is symmetric
  C -= v * Y.h.transpose() + Y.h * v.transpose();  // [v][h] + [h][v] = h v^T + v h^T - 2 (v.h) 1
  C.diagonal().array() += 2 * v.dot(Y.h);
  C -= skew<double>(k);
}

void forward(const Model& model, const Kinematics<double>& kin, std::span<const V6> fext, RneaDerivatives& d,
             const V6& base) {
  const V6 zero = V6::Zero();
  for (int i = 0; i < model.njoints(); ++i) {
    const Joint& joint = model.joints[i];
    const V6& vp = joint.parent < 0 ? zero : kin.v[joint.parent];
    const V6& ap = joint.parent < 0 ? base : kin.a[joint.parent];
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
      const V6 S = kin.J.col(k);
      const V6 Psid = cross_motion(vp, S);
      d.Psid.col(k) = Psid;
      d.Psidd.col(k) = cross_motion(ap, S) + cross_motion(vp, Psid);
      d.Sv.col(k) = Psid + cross_motion(kin.v[i], S);
    }
    add_rates(kin.Y[i], kin.v[i], d.l[i], d.C[i]);
    d.f[i] = kin.Y[i] * kin.a[i] + cross_force(kin.v[i], kin.Y[i] * kin.v[i]);
    if (!fext.empty()) d.f[i] -= fext[i];
  }
}

// Row and column i of the derivatives, for the coordinates k of joint i.
void fill(const Model& model, const Kinematics<double>& kin, const Inertia<double>& Yc, int i, RneaDerivatives& d) {
  const Joint& joint = model.joints[i];
  for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
    const V6 S = kin.J.col(k), Psid = d.Psid.col(k);
    const V6 YS = Yc * S;
    const V3 BS = 2 * d.l[i].cross(S.head<3>()) + d.C[i].transpose() * S.tail<3>();  // 2B^T S = [0; BS]
    V6 Fq = Yc * d.Psidd.col(k), Fv = Yc * d.Sv.col(k);
    Fq.head<3>() -= 2 * d.l[i].cross(Psid.tail<3>());
    Fq.tail<3>() += d.C[i] * Psid.tail<3>();
    Fv.head<3>() -= 2 * d.l[i].cross(S.tail<3>());
    Fv.tail<3>() += d.C[i] * S.tail<3>();
    int at = model.M_begin[k];
    const auto entry = [&](int j) {
      d.dq_lower[at] = YS.dot(d.Psidd.col(j)) + BS.dot(d.Psid.col(j).tail<3>());
      d.dv_lower[at] = YS.dot(d.Sv.col(j)) + BS.dot(kin.J.col(j).tail<3>());
      d.dq_upper[at] = Fq.dot(kin.J.col(j));
      d.dv_upper[at] = Fv.dot(kin.J.col(j));
      ++at;
    };
    int j = k;
    for (; j >= joint.idx_v; --j) entry(j);  // within the joint, S_i and the force turn together
    Fq += cross_force(S, d.f[i]);
    for (j = model.dof_parent[joint.idx_v]; j >= 0; j = model.dof_parent[j]) entry(j);
  }
}

}  // namespace

void rnea_derivatives(const Model& model, const Kinematics<double>& kin, std::span<const Inertia<double>> Yc,
                      std::span<const V6> fext, RneaDerivatives& d) {
  forward(model, kin, fext, d, kin.a_base);
  for (int i = model.njoints() - 1; i >= 0; --i) {
    fill(model, kin, Yc[i], i, d);
    const int parent = model.joints[i].parent;
    if (parent < 0) continue;
    d.l[parent] += d.l[i];
    d.C[parent] += d.C[i];
    d.f[parent] += d.f[i];
  }
}

void unpack_tree(const Model& model, std::span<const double> lower, std::span<const double> upper,
                 Eigen::Ref<Eigen::MatrixXd> out) {
  out.setZero();
  for (int i = 0; i < model.nv; ++i) {
    int at = model.M_begin[i];
    for (int j = i; j >= 0; j = model.dof_parent[j], ++at) {
      out(j, i) = upper[at];
      out(i, j) = lower[at];
    }
  }
}

}  // namespace manycontact
