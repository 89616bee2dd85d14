// Computes jvp, vjp as derivatives/products.cpp, but in body frames; unknowns are all bodies' accelerations and forces.

#include "manycontact/contact/products.hpp"

#include "../../derivatives/products.hpp"
#include "../../internal.hpp"
#include "bodies.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/contact/body_rows.hpp"

namespace manycontact {

namespace {

using V6 = Vec6<double>;

V6 combine(const BodySystem& s, int i, const double* x) {  // S x, with the motion columns S of node i's joint
  const int first = s.pattern->first_dof[i];
  V6 out = s.S.col(first) * x[first];
  for (int k = first + 1; k < first + s.pattern->ndof[i]; ++k) out += s.S.col(k) * x[k];
  return out;
}

V6 of_parent(const BodySystem& s, int i, const std::vector<V6>& x) {  // parent's x at node i's origin; 0 at a base
  const int parent = s.pattern->parent[i];
  return parent < 0 ? V6(V6::Zero()) : motion_at(x[parent], s.r[i]);
}

int node_of(const BodiesSystem& form, const Attachment& at) {
  return node_of(*form.factor.system.pattern, form.owner.island, at);
}

template <class Use>
void each_node(const BodiesSystem& form, Use&& use) {  // calls use(node, the robot's kinematics, joint of the robot)
  const std::vector<int>& offset = form.factor.system.pattern->node_offset;
  for (std::size_t k = 0; k < form.kin.size(); ++k)
    for (int i = 0; i < static_cast<int>(form.kin[k].v.size()); ++i) use(offset[k] + i, form.kin[k], i);
}

// Computes the bodies' displacements and velocity changes along (dq, dv). Computes the changes of the joints' relative
// accelerations S qdd + c, inertial forces Y a + p and torques S^T f, at constant qdd, a and f.
void tangent_bodies(BodiesSystem& form, const double* dq, const double* dv) {
  const BodySystem& s = form.factor.system;
  const BodyVectors& x = form.solution.x;
  BodyVectors& b = form.products.b;
  each_node(form, [&](int i, const BodyKinematics<double>& kin, int joint) {
    const int parent = s.pattern->parent[i];
    BodyVariation& o = form.body[i];
    V6 vJ = kin.v[joint];
    o.xi = combine(s, i, dq);
    o.v = combine(s, i, dv);
    o.u.setZero();
    o.a.setZero();
    if (parent >= 0) {
      vJ -= motion_at(kin.v[joint - (i - parent)], s.r[i]);
      o.xi += motion_at(form.body[parent].xi, s.r[i]);
    }
    const V6 dvJ = o.v + cross_motion(o.xi, vJ);
    o.v = dvJ;
    if (parent >= 0) o.v += motion_at(form.body[parent].v, s.r[i]);
    const V6 &v = kin.v[joint], &a = x.motion[i], &xi = o.xi;
    b.motion[i] = cross_motion(xi, combine(s, i, x.joints.data())) + cross_motion(o.v, vJ) + cross_motion(v, dvJ);
    const Inertia<double>& Y = s.Y[i];
    const V6 Yv = Y * v, dYv = cross_force(xi, Yv) - Y * cross_motion(xi, v) + Y * o.v;
    b.force[i] = cross_force(xi, Y * a) - Y * cross_motion(xi, a) + cross_force(o.v, Yv) + cross_force(v, dYv);
    const V6 turned = cross_force(xi, x.force[i]);  // -(xi x S)^T f = S^T (xi x* f)
    for (int k = s.pattern->first_dof[i]; k < s.pattern->first_dof[i] + s.pattern->ndof[i]; ++k)
      b.joints[k] = s.S.col(k).dot(turned);
  });
}

void tangent_contacts(const Scene& scene, const SceneData& data, BodiesSystem& form) {
  const Island& island = form.owner.island;
  BodyVectors& b = form.products.b;
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    const Contact& contact = scene.contacts[c];
    const ContactData<double>& rows = form.contacts[k];
    const int A = node_of(form, contact.A), B = node_of(form, contact.B);
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> dr2(contact.rows());
    V6 dF;
    contact_tangent<double>(contact, rows, A < 0 ? internal::kAtRest : form.body[A],
                            B < 0 ? internal::kAtRest : form.body[B], data.f.segment(data.f_offset[c], contact.rows()),
                            dr2, dF);
    each_body_force(contact, rows, dF,
                    [&](const Attachment& at, const V6& force) { b.force[node_of(form, at)] -= force; });
    b.rows.segment(island.row_offset[k], contact.rows()) = -dr2;
  }
}

void adjoint_bodies(BodiesSystem& form) {  // gradients of inertial forces Y a + p, from the adjoint products.x
  const BodySystem& s = form.factor.system;
  each_node(form, [&](int i, const BodyKinematics<double>& kin, int joint) {
    const Inertia<double>& Y = s.Y[i];
    const V6 &v = kin.v[joint], &a = form.solution.x.motion[i], &u = form.products.x.motion[i];
    const V6 Ya = Y * a, Yv = Y * v, Yu = Y * u;
    const V6 w = cross_motion(u, v), Yw = Y * w;  // u . (v x* Y v) = (u x v) . Y v
    form.body[i] = {-cross_force(u, Ya) - cross_force(a, Yu) - cross_force(w, Yv) - cross_force(v, Yw),
                    Ya + cross_force(v, Yv), Yw - cross_force(u, Yv), Yu};
  });
}

void adjoint_contacts(const Scene& scene, const SceneData& data, BodiesSystem& form) {
  const Island& island = form.owner.island;
  const BodyVectors& x = form.products.x;
  const V6 none = V6::Zero();
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    const Contact& contact = scene.contacts[c];
    const int A = node_of(form, contact.A), B = node_of(form, contact.B);
    BodyVariation nobody = internal::kAtRest;
    contact_adjoint<double>(contact, form.contacts[k], A < 0 ? none : x.motion[A], B < 0 ? none : x.motion[B],
                            data.f.segment(data.f_offset[c], contact.rows()),
                            x.rows.segment(island.row_offset[k], contact.rows()), A < 0 ? nobody : form.body[A],
                            B < 0 ? nobody : form.body[B]);
  }
}

// Converts gradients per body into gradients wq, wv per coordinate, as pull_back (algorithm/rnea_products.hpp) does.
void pull_back_bodies(BodiesSystem& form, double* wq, double* wv) {
  const BodySystem& s = form.factor.system;
  const BodyPattern& p = *s.pattern;
  const BodyVectors &x = form.solution.x, &l = form.products.x;
  for (int k = static_cast<int>(form.kin.size()) - 1; k >= 0; --k)
    for (int joint = static_cast<int>(form.kin[k].v.size()) - 1; joint >= 0; --joint) {
      const int i = p.node_offset[k] + joint, parent = p.parent[i];
      BodyVariation& g = form.body[i];
      const V6& v = form.kin[k].v[joint];
      V6 vJ = v;
      if (parent >= 0) vJ -= motion_at(form.kin[k].v[parent - p.node_offset[k]], s.r[i]);
      const V6 uJ = l.motion[i] - of_parent(s, i, l.motion), aJ = combine(s, i, x.joints.data());
      g.v += cross_force(vJ, g.a);
      const V6 t = g.v - cross_force(v, g.a);  // gradient with respect to S v
      g.xi += cross_force(uJ, g.u) + cross_force(vJ, t) + cross_force(aJ, g.a);
      for (int m = p.first_dof[i]; m < p.first_dof[i] + p.ndof[i]; ++m) {
        wq[m] = -s.S.col(m).dot(g.xi);  // wq, wv = -(dr/d(q, v))^T l
        wv[m] = -s.S.col(m).dot(t);
      }
      if (parent < 0) continue;
      BodyVariation& o = form.body[parent];
      o.xi += force_from(g.xi, s.r[i]);
      o.u += force_from(g.u, s.r[i]);
      o.v += force_from(g.v, s.r[i]);
      o.a += force_from(g.a, s.r[i]);
    }
}

}  // namespace

void internal::evaluate_rows_at_solution(const Scene& scene, BodiesSystem& form) {
  const Island& island = form.owner.island;
  while (form.contacts.size() < island.contacts.size())
    form.contacts.emplace_back(scene.contacts[island.contacts[form.contacts.size()]], ContactSupport{});
  const V6 none = V6::Zero();
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    const auto a = [&](const Attachment& at) -> const V6& {
      const int node = node_of(form, at);
      return node < 0 ? none : form.solution.x.motion[node];
    };
    body_rows(scene, contact, kinematics_at(form, contact.A), kinematics_at(form, contact.B), a(contact.A),
              a(contact.B), form.contacts[k]);
  }
}

bool BodiesSystem::jvp(const Scene& scene, SceneData& data, ThreadWork&, const TangentProduct& p) {
  if (!make_current(scene, data)) return false;
  const Island& island = owner.island;
  BodySolve& w = products;
  internal::evaluate_rows_at_solution(scene, *this);
  body.resize(factor.system.pattern->nodes);
  products.resize(*factor.system.pattern);
  BodyVectors& in = w.dx;  // dq, dv of the island, until dx replaces dq
  BodyVectors& in2 = w.residual.r;
  each_velocity_block(scene, island, [&](int from, int to, int n) {
    in.joints.segment(to, n) = p.dq.segment(from, n);
    in2.joints.segment(to, n) = p.dv.segment(from, n);
  });
  tangent_bodies(*this, in.joints.data(), in2.joints.data());
  tangent_contacts(scene, data, *this);
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    const int o = island.dof_offset[k];
    w.b.joints.segment(o, robot.model->nv) += p.dtau.segment(robot.idx_v, robot.model->nv);
    add_friction_change(*robot.model, data.v.data() + robot.idx_v, p.dv.data() + robot.idx_v, w.b.joints.data() + o);
  }
  (void)solve_refined(factor.system, factor.ldl, w, 1);
  each_velocity_block(scene, island,
                      [&](int to, int from, int n) { p.da.segment(to, n) = w.x.joints.segment(from, n); });
  each_force_block(scene, data.f_offset, island,
                   [&](int to, int from, int n) { p.df.segment(to, n) = -w.x.rows.segment(from, n); });
  return true;
}

bool BodiesSystem::vjp(const Scene& scene, SceneData& data, ThreadWork&, const AdjointProduct& p) {
  if (!make_current(scene, data)) return false;
  const Island& island = owner.island;
  BodySolve& w = products;
  internal::evaluate_rows_at_solution(scene, *this);
  body.resize(factor.system.pattern->nodes);
  products.resize(*factor.system.pattern);
  w.b.set_zero();
  each_velocity_block(scene, island,
                      [&](int from, int to, int n) { w.b.joints.segment(to, n) = p.wa.segment(from, n); });
  each_force_block(scene, data.f_offset, island,
                   [&](int from, int to, int n) { w.b.rows.segment(to, n) = -p.wf.segment(from, n); });
  (void)solve_refined(factor.system, factor.ldl, w, 1);
  adjoint_bodies(*this);
  adjoint_contacts(scene, data, *this);
  pull_back_bodies(*this, w.dx.joints.data(), w.residual.r.joints.data());
  each_velocity_block(scene, island, [&](int to, int from, int n) {
    p.wq.segment(to, n) = w.dx.joints.segment(from, n);
    p.wv.segment(to, n) = w.residual.r.joints.segment(from, n);
  });
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    const double* l = w.x.joints.data() + island.dof_offset[k];
    std::copy_n(l, robot.model->nv, p.wtau.data() + robot.idx_v);
    add_friction_change(*robot.model, data.v.data() + robot.idx_v, l, p.wv.data() + robot.idx_v);
  }
  return true;
}

bool BodiesSystem::invert(const Scene& scene, SceneData& data, ThreadWork&, ProductWork& work) {
  if (!make_current(scene, data)) return false;
  products.resize(*factor.system.pattern);
  BodySolve& w = products;
  w.b.set_zero();
  each_velocity_block(scene, owner.island,
                      [&](int from, int to, int n) { w.b.joints.segment(to, n) = work.a.segment(from, n); });
  each_force_block(scene, data.f_offset, owner.island,
                   [&](int from, int to, int n) { w.b.rows.segment(to, n) = work.y.segment(from, n); });
  (void)solve_refined(factor.system, factor.ldl, w, 1);
  each_velocity_block(scene, owner.island,
                      [&](int to, int from, int n) { work.a.segment(to, n) = w.x.joints.segment(from, n); });
  each_force_block(scene, data.f_offset, owner.island,
                   [&](int to, int from, int n) { work.y.segment(to, n) = w.x.rows.segment(from, n); });
  return true;
}

}  // namespace manycontact
