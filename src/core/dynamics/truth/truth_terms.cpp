#include "truth_terms.hpp"

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/algorithm/joint_friction.hpp"

namespace manycontact::internal {

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

using Real = InstantiatedScalar;
template TruthTerms<Real> truth_terms<Real>(const Scene&, const std::vector<char>&, const VecX<Real>&,
                                            const VecX<Real>&, std::span<const Vec6<Real>>);
template VecX<Real> bias_torques<Real>(const Scene&, const TruthTerms<Real>&, int, const VecX<Real>&);

}  // namespace manycontact::internal
