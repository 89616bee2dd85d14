#include "manycontact/algorithm/rnea_products.hpp"

namespace manycontact {

namespace {

using V6 = Vec6<double>;

// S x for the coordinates of a joint.
V6 combine(const Joint& joint, const Kinematics<double>& kin, const double* x) {
  V6 out = kin.J.col(joint.idx_v) * x[joint.idx_v];
  for (int k = joint.idx_v + 1; k < joint.idx_v + joint.nv(); ++k) out += kin.J.col(k) * x[k];
  return out;
}

V6 parent_of(const Joint& joint, const std::vector<V6>& x) {
  return joint.parent < 0 ? V6(V6::Zero()) : x[joint.parent];
}

}  // namespace

void tangent_motions(const Model& model, const Kinematics<double>& kin, const double* qdd, const double* dq,
                     const double* dv, std::vector<BodyVariation>& out) {
  const V6 zero = V6::Zero();
  const BodyVariation rest{zero, zero, zero, zero};
  for (int i = 0; i < model.njoints(); ++i) {
    const Joint& joint = model.joints[i];
    const BodyVariation& p = joint.parent < 0 ? rest : out[joint.parent];
    const V6 vJ = kin.v[i] - parent_of(joint, kin.v), aJ = combine(joint, kin, qdd);
    BodyVariation& o = out[i];
    o.xi = p.xi + combine(joint, kin, dq);
    const V6 dvJ = cross_motion(o.xi, vJ) + combine(joint, kin, dv);  // of S v
    o.v = p.v + dvJ;
    o.a = p.a + cross_motion(o.xi, aJ) + cross_motion(o.v, vJ) + cross_motion(kin.v[i], dvJ);
    o.u.setZero();
  }
}

void tangent_torques(const Model& model, const Kinematics<double>& kin, const std::vector<BodyVariation>& motion,
                     const std::vector<V6>& fext, const std::vector<V6>& dfext, std::vector<V6>& f, std::vector<V6>& df,
                     double* dtau) {
  for (int i = 0; i < model.njoints(); ++i) {
    const Inertia<double>& Y = kin.Y[i];
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
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) dtau[k] = kin.J.col(k).dot(turned);
    if (joint.parent < 0) continue;
    f[joint.parent] += f[i];
    df[joint.parent] += df[i];
  }
}

void virtual_velocities(const Model& model, const Kinematics<double>& kin, const double* w, std::vector<V6>& u) {
  for (int i = 0; i < model.njoints(); ++i) u[i] = parent_of(model.joints[i], u) + combine(model.joints[i], kin, w);
}

void add_body_adjoints(const Model& model, const Kinematics<double>& kin, const std::vector<V6>& u,
                       std::vector<BodyVariation>& adjoint) {
  for (int i = 0; i < model.njoints(); ++i) {
    const Inertia<double>& Y = kin.Y[i];
    const V6 &v = kin.v[i], &a = kin.a[i];
    const V6 Ya = Y * a, Yv = Y * v, Yu = Y * u[i];
    const V6 w = cross_motion(u[i], v), Yw = Y * w;  // u . (v x* Y v) = (u x v) . Y v
    BodyVariation& g = adjoint[i];
    g.u += Ya + cross_force(v, Yv);
    g.a += Yu;
    g.v += Yw - cross_force(u[i], Yv);
    g.xi -= cross_force(u[i], Ya) + cross_force(a, Yu) + cross_force(w, Yv) + cross_force(v, Yw);
  }
}

void pull_back(const Model& model, const Kinematics<double>& kin, const double* qdd, const std::vector<V6>& u,
               std::vector<BodyVariation>& adjoint, double* wq, double* wv) {
  for (int i = model.njoints() - 1; i >= 0; --i) {
    const Joint& joint = model.joints[i];
    BodyVariation& g = adjoint[i];
    const V6 vJ = kin.v[i] - parent_of(joint, kin.v), uJ = u[i] - parent_of(joint, u), aJ = combine(joint, kin, qdd);
    g.v += cross_force(vJ, g.a);                    // a_i depends on v_i by v_i x S v
    const V6 s = g.v - cross_force(kin.v[i], g.a);  // gradient with respect to S v
    g.xi += cross_force(uJ, g.u) + cross_force(vJ, s) + cross_force(aJ, g.a);
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
      wq[k] = kin.J.col(k).dot(g.xi);
      wv[k] = kin.J.col(k).dot(s);
    }
    if (joint.parent < 0) continue;
    BodyVariation& p = adjoint[joint.parent];
    p.xi += g.xi;
    p.u += g.u;
    p.v += g.v;
    p.a += g.a;
  }
}

}  // namespace manycontact
