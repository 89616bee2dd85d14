#include "manycontact/algorithm/rnea_products.hpp"

namespace manycontact {

namespace {

template <class S>
Vec6<S> combine(const Joint& joint, const Kinematics<S>& kin, const S* x) {
  Vec6<S> out = kin.J.col(joint.idx_v) * x[joint.idx_v];
  for (int k = joint.idx_v + 1; k < joint.idx_v + joint.nv(); ++k) out += kin.J.col(k) * x[k];
  return out;
}

template <class S>
Vec6<S> parent_of(const Joint& joint, const std::vector<Vec6<S>>& x) {
  return joint.parent < 0 ? Vec6<S>(Vec6<S>::Zero()) : x[joint.parent];
}

}  // namespace

template <class S>
void tangent_motions(const Model& model, const Kinematics<S>& kin, const S* qdd, const S* dq, const S* dv,
                     std::vector<BodyVariationOf<S>>& out) {
  using V6 = Vec6<S>;
  const V6 zero = V6::Zero();
  const BodyVariationOf<S> rest{zero, zero, zero, zero};
  for (int i = 0; i < model.njoints(); ++i) {
    const Joint& joint = model.joints[i];
    const BodyVariationOf<S>& p = joint.parent < 0 ? rest : out[joint.parent];
    const V6 vJ = kin.v[i] - parent_of(joint, kin.v), aJ = combine(joint, kin, qdd);
    BodyVariationOf<S>& o = out[i];
    o.xi = p.xi + combine(joint, kin, dq);
    const V6 dvJ = cross_motion(o.xi, vJ) + combine(joint, kin, dv);  // change of S v
    o.v = p.v + dvJ;
    o.a = p.a + cross_motion(o.xi, aJ) + cross_motion(o.v, vJ) + cross_motion(kin.v[i], dvJ);
    o.u.setZero();
  }
}

template <class S>
void tangent_torques(const Model& model, const Kinematics<S>& kin, const std::vector<BodyVariationOf<S>>& motion,
                     const std::vector<Vec6<S>>& fext, const std::vector<Vec6<S>>& dfext, std::vector<Vec6<S>>& f,
                     std::vector<Vec6<S>>& df, S* dtau) {
  using V6 = Vec6<S>;
  for (int i = 0; i < model.njoints(); ++i) {
    const Inertia<S>& Y = kin.Y[i];
    const V6 &v = kin.v[i], &a = kin.a[i], &xi = motion[i].xi;
    const V6 Ya = Y * a, Yv = Y * v;
    const V6 dYa = cross_force(xi, Ya) - Y * cross_motion(xi, a) + Y * motion[i].a;  // d(Y a)
    const V6 dYv = cross_force(xi, Yv) - Y * cross_motion(xi, v) + Y * motion[i].v;
    f[i] = Ya + cross_force(v, Yv) - fext[i];
    df[i] = dYa + cross_force(motion[i].v, Yv) + cross_force(v, dYv) - dfext[i];
  }
  for (int i = model.njoints() - 1; i >= 0; --i) {
    const Joint& joint = model.joints[i];
    const V6 turned = df[i] - cross_force(motion[i].xi, f[i]);  // (xi x S)^T f = -S^T (xi x* f)
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) dtau[k] = dot(kin.J.col(k), turned);
    if (joint.parent < 0) continue;
    f[joint.parent] += f[i];
    df[joint.parent] += df[i];
  }
}

template <class S>
void virtual_velocities(const Model& model, const Kinematics<S>& kin, const S* w, std::vector<Vec6<S>>& u) {
  for (int i = 0; i < model.njoints(); ++i) u[i] = parent_of(model.joints[i], u) + combine(model.joints[i], kin, w);
}

template <class S>
void add_body_adjoints(const Model& model, const Kinematics<S>& kin, const std::vector<Vec6<S>>& u,
                       std::vector<BodyVariationOf<S>>& adjoint) {
  using V6 = Vec6<S>;
  for (int i = 0; i < model.njoints(); ++i) {
    const Inertia<S>& Y = kin.Y[i];
    const V6 &v = kin.v[i], &a = kin.a[i];
    const V6 Ya = Y * a, Yv = Y * v, Yu = Y * u[i];
    const V6 w = cross_motion(u[i], v), Yw = Y * w;  // u . (v x* Y v) = (u x v) . Y v
    BodyVariationOf<S>& g = adjoint[i];
    g.u += Ya + cross_force(v, Yv);
    g.a += Yu;
    g.v += Yw - cross_force(u[i], Yv);
    g.xi -= cross_force(u[i], Ya) + cross_force(a, Yu) + cross_force(w, Yv) + cross_force(v, Yw);
  }
}

template <class S>
void pull_back(const Model& model, const Kinematics<S>& kin, const S* qdd, const std::vector<Vec6<S>>& u,
               std::vector<BodyVariationOf<S>>& adjoint, S* wq, S* wv) {
  using V6 = Vec6<S>;
  for (int i = model.njoints() - 1; i >= 0; --i) {
    const Joint& joint = model.joints[i];
    BodyVariationOf<S>& g = adjoint[i];
    const V6 vJ = kin.v[i] - parent_of(joint, kin.v), uJ = u[i] - parent_of(joint, u), aJ = combine(joint, kin, qdd);
    g.v += cross_force(vJ, g.a);                    // a_i depends on v_i by its term v_i x S v
    const V6 s = g.v - cross_force(kin.v[i], g.a);  // gradient with respect to S v
    g.xi += cross_force(uJ, g.u) + cross_force(vJ, s) + cross_force(aJ, g.a);
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
      wq[k] = dot(kin.J.col(k), g.xi);
      wv[k] = dot(kin.J.col(k), s);
    }
    if (joint.parent < 0) continue;
    BodyVariationOf<S>& p = adjoint[joint.parent];
    p.xi += g.xi;
    p.u += g.u;
    p.v += g.v;
    p.a += g.a;
  }
}

using Scalar = InstantiatedScalar;
template void tangent_motions<Scalar>(const Model&, const Kinematics<Scalar>&, const Scalar*, const Scalar*,
                                      const Scalar*, std::vector<BodyVariationOf<Scalar>>&);
template void tangent_torques<Scalar>(const Model&, const Kinematics<Scalar>&,
                                      const std::vector<BodyVariationOf<Scalar>>&, const std::vector<Vec6<Scalar>>&,
                                      const std::vector<Vec6<Scalar>>&, std::vector<Vec6<Scalar>>&,
                                      std::vector<Vec6<Scalar>>&, Scalar*);
template void virtual_velocities<Scalar>(const Model&, const Kinematics<Scalar>&, const Scalar*,
                                         std::vector<Vec6<Scalar>>&);
template void add_body_adjoints<Scalar>(const Model&, const Kinematics<Scalar>&, const std::vector<Vec6<Scalar>>&,
                                        std::vector<BodyVariationOf<Scalar>>&);
template void pull_back<Scalar>(const Model&, const Kinematics<Scalar>&, const Scalar*,
                                const std::vector<Vec6<Scalar>>&, std::vector<BodyVariationOf<Scalar>>&, Scalar*,
                                Scalar*);

}  // namespace manycontact
