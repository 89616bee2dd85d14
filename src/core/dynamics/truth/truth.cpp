#include "manycontact/dynamics/truth.hpp"

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/rank/row_size.hpp"
#include "manycontact/rank/row_units.hpp"
#include "truth_terms.hpp"

namespace manycontact {

namespace internal {

template <class S>
TruthTerms<S> truth_terms(const Scene& scene, const std::vector<char>& active, const VecX<S>& q, const VecX<S>& v,
                          std::span<const Vec6<S>> w) {
  TruthTerms<S> t;
  for (const Robot& robot : scene.robots) {
    const Model& model = *robot.model;
    RobotQuantities<S>& r = t.robots.emplace_back(model);
    evaluate_bias<S>(model, robot.base, q.segment(robot.idx_q, model.nq), v.segment(robot.idx_v, model.nv),
                     scene.gravity, r);
    VecX<S> friction = VecX<S>::Zero(model.nv);
    add_friction<S>(model, v.data() + robot.idx_v, friction.data());
    r.h -= friction;
    crba<S>(model, r.kin, r.Yc, t.M.emplace_back(packed_size(model)).data());
  }
  AppliedForces<S> forces(scene);
  VecX<S> applied = VecX<S>::Zero(scene.nv);
  add_applied_forces<S>(scene, q.data(), v.data(), w, forces, applied.data());
  for (int r = 0; r < scene.nrobots(); ++r)
    t.robots[r].h -= applied.segment(scene.robots[r].idx_v, scene.robots[r].model->nv);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    const ContactSupport& support = t.supports.emplace_back(contact_support(scene, contact));
    ContactData<S>& rows = t.contacts.emplace_back(contact, support);
    if (active[c])
      contact_rows<S>(scene, contact, support, t.robots[contact.A.robot].kin,
                      contact.B.robot < 0 ? nullptr : &t.robots[contact.B.robot].kin, rows);
  }
  return t;
}

template <class S>
VecX<S> bias_torques(const Scene& scene, const TruthTerms<S>& t, int robot, const VecX<S>& u) {
  const Model& model = *scene.robots[robot].model;
  VecX<S> out = -t.robots[robot].h;
  for (int k = 0; k < model.nu(); ++k) out[model.actuated[k]] += u[scene.robots[robot].idx_u + k];
  return out;
}

template <class S>
void dense_truth(const Scene& scene, const TruthTerms<S>& t, const Island& island, const std::vector<int>& f_offset,
                 const VecX<S>& u, Truth<S>& out) {
  DenseKkt<S> kkt;
  kkt.M.setZero(island.nv, island.nv);
  kkt.J.setZero(island.nc, island.nv);
  kkt.row_scale.resize(island.nc);
  kkt.delta = S(scene.damping);
  MatX<S> b1(island.nv, 1), b2(island.nc, 1), a, f;
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const int r = island.robots[k], o = island.dof_offset[k];
    const Model& model = *scene.robots[r].model;
    unpack_inertia<S>(model, t.M[r].data(), kkt.M.block(o, o, model.nv, model.nv));
    b1.col(0).segment(o, model.nv) = bias_torques(scene, t, r, u);
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    const Contact& contact = scene.contacts[c];
    const ContactData<S>& rows = t.contacts[c];
    int j = 0;
    const int o = island.row_offset[k];
    for (int i = 0; i < contact.rows(); ++i) kkt.row_scale[o + i] = row_size(contact, rows, i);
    for (int i : t.supports[c].a)
      kkt.J.col(first_dof(island, contact.A) + i).segment(o, contact.rows()) = rows.J.col(j++);
    for (int i : t.supports[c].b)
      kkt.J.col(first_dof(island, contact.B) + i).segment(o, contact.rows()) = rows.J.col(j++);
    b2.block(o, 0, contact.rows(), 1) = -rows.a0;
    for (int i = 0; i < contact.rows(); ++i) {
      const S unit(row_unit(scene, contact, i));
      kkt.row_scale[o + i] *= unit;
      kkt.J.row(o + i) *= unit;
      b2.row(o + i) *= unit;
    }
  }
  factor<S>(kkt);
  solve<S>(kkt, b1, b2, a, f);
  out.rank.push_back(kkt.rank);
  out.regular.push_back(kkt.regular);
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    out.a.segment(robot.idx_v, robot.model->nv) = a.col(0).segment(island.dof_offset[k], robot.model->nv);
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    for (int i = 0; i < contact.rows(); ++i)
      out.f[f_offset[island.contacts[k]] + i] = f(island.row_offset[k] + i, 0) * S(row_unit(scene, contact, i));
  }
}

using Real = InstantiatedScalar;
template TruthTerms<Real> truth_terms<Real>(const Scene&, const std::vector<char>&, const VecX<Real>&,
                                            const VecX<Real>&, std::span<const Vec6<Real>>);
template VecX<Real> bias_torques<Real>(const Scene&, const TruthTerms<Real>&, int, const VecX<Real>&);
template void dense_truth<Real>(const Scene&, const TruthTerms<Real>&, const Island&, const std::vector<int>&,
                                const VecX<Real>&, Truth<Real>&);

}  // namespace internal
}  // namespace manycontact
