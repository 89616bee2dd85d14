#include "products.hpp"

#include "../internal.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/contact/products.hpp"

namespace manycontact::internal {

namespace {

using V6 = Vec6<double>;

const BodyVariation& body(const ProductWork& pd, const Attachment& at) {
  return moves(at) ? pd.robots[at.robot].body[at.joint] : kAtRest;
}

}  // namespace

void tangent_right_side(const Scene& scene, const SceneData& data, const Island& island, const TangentProduct& t,
                        ProductWork& pd) {
  const Workspace& w = *data.workspace;
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    ProductWork::OfRobot& p = pd.robots[r];
    tangent_motions(*robot.model, w.robots[r].kin, data.a.data() + robot.idx_v, t.dq.data() + robot.idx_v,
                    t.dv.data() + robot.idx_v, p.body);
    std::fill(p.fext.begin(), p.fext.end(), V6(V6::Zero()));
    std::fill(p.dfext.begin(), p.dfext.end(), V6(V6::Zero()));
  }
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    const ContactData<double>& rows = w.linearisation->contacts[c];
    const auto f = data.f.segment(data.f_offset[c], contact.rows());
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> dr2(contact.rows());
    V6 dF;
    contact_tangent<double>(contact, rows, body(pd, contact.A), body(pd, contact.B), f, dr2, dF);
    const V6 F = rows.W.transpose() * f;
    each_body_force(contact, rows, F,
                    [&](const Attachment& at, const V6& force) { pd.robots[at.robot].fext[at.joint] += force; });
    each_body_force(contact, rows, dF,
                    [&](const Attachment& at, const V6& force) { pd.robots[at.robot].dfext[at.joint] += force; });
    pd.y.segment(data.f_offset[c], contact.rows()) = -dr2;
  }
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    const Model& model = *robot.model;
    ProductWork::OfRobot& p = pd.robots[r];
    const RobotData& rd = w.robots[r];
    tangent_torques(model, rd.kin, p.body, p.fext, p.dfext, p.f, p.df, p.w.data());
    double* b = pd.a.data() + robot.idx_v;
    for (int i = 0; i < model.nv; ++i) b[i] = -p.w[i];
    add_friction_change(model, data.v.data() + robot.idx_v, t.dv.data() + robot.idx_v, b);
    for (int i = 0; i < model.nv; ++i) b[i] += t.dtau[robot.idx_v + i];
  }
}

void take_tangent(const Scene& scene, const SceneData& data, const Island& island, const ProductWork& pd,
                  const TangentProduct& t) {
  each_velocity_block(scene, island, [&](int at, int, int n) { t.da.segment(at, n) = pd.a.segment(at, n); });
  each_force_block(scene, data.f_offset, island,
                   [&](int at, int, int n) { t.df.segment(at, n) = -pd.y.segment(at, n); });
}

void adjoint_right_side(const Scene& scene, const SceneData& data, const Island& island, const AdjointProduct& t,
                        ProductWork& pd) {
  each_velocity_block(scene, island, [&](int at, int, int n) { pd.a.segment(at, n) = t.wa.segment(at, n); });
  each_force_block(scene, data.f_offset, island,
                   [&](int at, int, int n) { pd.y.segment(at, n) = -t.wf.segment(at, n); });
}

void pull_back_island(const Scene& scene, const SceneData& data, const Island& island, ProductWork& pd,
                      const AdjointProduct& t) {
  const Workspace& w = *data.workspace;
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    const Model& model = *robot.model;
    ProductWork::OfRobot& p = pd.robots[r];
    const RobotData& rd = w.robots[r];
    const double* l = pd.a.data() + robot.idx_v;
    std::copy_n(l, model.nv, t.wtau.data() + robot.idx_v);
    virtual_velocities(model, rd.kin, l, p.u);
    std::fill(p.body.begin(), p.body.end(), kAtRest);
    add_body_adjoints(model, rd.kin, p.u, p.body);
  }
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    const auto l = pd.y.segment(data.f_offset[c], contact.rows());
    BodyVariation nobody = kAtRest;
    const auto of = [&](const Attachment& at) -> BodyVariation& {
      return moves(at) ? pd.robots[at.robot].body[at.joint] : nobody;
    };
    const auto u = [&](const Attachment& at) { return moves(at) ? pd.robots[at.robot].u[at.joint] : V6(V6::Zero()); };
    contact_adjoint<double>(contact, w.linearisation->contacts[c], u(contact.A), u(contact.B),
                            data.f.segment(data.f_offset[c], contact.rows()), l, of(contact.A), of(contact.B));
  }
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    ProductWork::OfRobot& p = pd.robots[r];
    pull_back(*robot.model, w.robots[r].kin, data.a.data() + robot.idx_v, p.u, p.body, t.wq.data() + robot.idx_v,
              t.wv.data() + robot.idx_v);
    t.wq.segment(robot.idx_v, robot.model->nv) *= -1;  // w = -(dr)^T l
    t.wv.segment(robot.idx_v, robot.model->nv) *= -1;
    add_friction_change(*robot.model, data.v.data() + robot.idx_v, pd.a.data() + robot.idx_v,
                        t.wv.data() + robot.idx_v);
  }
}

}  // namespace manycontact::internal
