#pragma once
// Action models of scenes, for tests.

#include <random>

#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {

enum class Actuated { kFloatingBase, kFull, kSquashed };

/// A custom actuation: tau = S tanh(u) - q-dependent and v-dependent springs on every coordinate with one number.
class SquashedActuation : public ActuationModelAbstract {
 public:
  explicit SquashedActuation(std::shared_ptr<StateMultibody> state) : ActuationModelAbstract(state, state->get_nv()) {
    for (const Robot& robot : state->get_model()->scene().robots)
      for (const Joint& joint : robot.model->joints)
        if (joint.nv() == 1) springs_.push_back({robot.idx_q + joint.idx_q, robot.idx_v + joint.idx_v});
  }
  void calc(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override {
    data->tau = 3 * u.array().tanh();
    for (const auto& [iq, iv] : springs_) data->tau[iv] -= 2 * x[iq] + 0.3 * x[state_->get_nq() + iv] * x[iq];
  }
  void calcDiff(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override {
    const int nv = static_cast<int>(state_->get_nv());
    for (int i = 0; i < nv; ++i) data->dtau_du.coeffRef(i, i) = 3 / std::pow(std::cosh(u[i]), 2);
    for (const auto& [iq, iv] : springs_) {
      data->dtau_dx.coeffRef(iv, iv) = -2 - 0.3 * x[state_->get_nq() + iv];
      data->dtau_dx.coeffRef(iv, nv + iv) = -0.3 * x[iq];
    }
  }
  void commands(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef&,
                const ConstVectorRef& tau) override {
    data->u = (tau / 3).array().atanh();
  }
  void torqueTransform(const std::shared_ptr<ActuationDataAbstract>&, const ConstVectorRef&,
                       const ConstVectorRef&) override {}

 private:
  std::vector<std::pair<int, int>> springs_;  // in q and in v
};

struct Problem {
  std::shared_ptr<StateMultibody> state;
  std::shared_ptr<ActuationModelAbstract> actuation;
  std::shared_ptr<ContactModelMultiple> contacts;
  std::shared_ptr<CostModelSum> costs;
  std::shared_ptr<ConstraintModelManager> constraints;
  double damping = 0;
  Eigen::VectorXd x, u;

  std::shared_ptr<DifferentialActionModelContactFwdDynamics> model(bool enable_force = true) const {
    return std::make_shared<DifferentialActionModelContactFwdDynamics>(state, actuation, contacts, costs, constraints,
                                                                       damping, enable_force);
  }
};

inline Problem make_problem(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                            const Eigen::VectorXd& u, Actuated how = Actuated::kFloatingBase) {
  Problem p;
  p.state = std::make_shared<StateMultibody>(scene);
  bool floats = false;
  for (const Robot& robot : scene.robots) floats |= robot.model->floating_base;
  if (how == Actuated::kSquashed)
    p.actuation = std::make_shared<SquashedActuation>(p.state);
  else if (how == Actuated::kFloatingBase && floats)
    p.actuation = std::make_shared<ActuationModelFloatingBase>(p.state);
  else
    p.actuation = std::make_shared<ActuationModelFull>(p.state);
  const std::size_t nu = p.actuation->get_nu();
  p.contacts = contacts_of_scene(p.state, scene, nu);
  p.costs = std::make_shared<CostModelSum>(p.state, nu);
  p.constraints = std::make_shared<ConstraintModelManager>(p.state, nu);
  p.damping = scene.damping;
  p.x.resize(q.size() + v.size());
  p.x << q, v;
  if (static_cast<Eigen::Index>(nu) == u.size()) {
    p.u = u;
  } else {
    std::mt19937 rng(4);
    p.u = random_vector(static_cast<int>(nu), rng);
  }
  return p;
}

inline Problem make_problem(const SceneFile& file, Actuated how = Actuated::kFloatingBase) {
  return make_problem(file.scene, file.q, file.v, file.u, how);
}

inline Problem make_problem(const RandomScene& s, Actuated how = Actuated::kFloatingBase) {
  return make_problem(s.scene, s.q, s.v, s.u, how);
}

/// Returns a robot so deep that a scene's own solve uses sparse-bodies, fixed at two links, with another one next to it
/// for odd seeds.
inline RandomScene deep_scene(int seed, bool floating) {
  std::mt19937 rng(static_cast<unsigned>(seed));
  SceneOptions options;
  options.nrobots = 1 + seed % 2;
  options.models = {
      {.njoints = 60, .floating_base = floating, .types = {JointType::kRevolute}, .branching = 0, .armature = 0.1},
      {.njoints = 4, .floating_base = true, .armature = 0.1}};
  options.ncontacts = 0;
  RandomScene s = random_scene(rng, options);
  s.v *= 0.1;
  for (const auto& [type, joint] : {std::pair(ContactType::k3D, 30), std::pair(ContactType::k6D, 59)}) {
    Contact c;
    c.name = "at" + std::to_string(joint);
    c.type = type;
    c.reference_frame = type == ContactType::k3D ? ReferenceFrame::kWorld : ReferenceFrame::kLocal;
    c.A = {0, joint, random_placement(rng, 0.2)};
    c.alpha = 20, c.beta = 10;
    resolve_reference(s.scene, s.q, true, true, c);
    add_contact(s.scene, c);
  }
  return s;
}

/// Calls calc and calcDiff at the problem's x and u, in a terminal node at x alone.
inline void evaluate(DifferentialActionModelAbstract& model,
                     const std::shared_ptr<DifferentialActionDataAbstract>& data, const Problem& p, bool terminal) {
  if (terminal)
    model.calc(data, p.x), model.calcDiff(data, p.x);
  else
    model.calc(data, p.x, p.u), model.calcDiff(data, p.x, p.u);
}

using FwdDynData = DifferentialActionDataContactFwdDynamics;
inline FwdDynData& as_fwddyn(const std::shared_ptr<DifferentialActionDataAbstract>& data) {
  return dynamic_cast<FwdDynData&>(*data);
}

}  // namespace manycontact::test
