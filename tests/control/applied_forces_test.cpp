// ExternalWrenches and springs act in nodes of optimal control: values agree with the simulation, derivatives with
// differences.

#include "control/nodes.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "simulation/scenes.hpp"
#include "support/applied.hpp"

namespace manycontact::test {
namespace {

RandomScene pushed(int seed, bool free) {
  std::mt19937 rng(static_cast<unsigned>(seed));
  RandomScene s;
  if (free) {
    s = free_scene(seed);
  } else {
    SceneOptions options;
    options.nrobots = 1 + seed % 3;
    options.models = {ModelOptions{.floating_base = true, .armature = 0.1}, ModelOptions{.armature = 0.1}};
    options.gains = 0.7;
    s = random_scene(rng, options);
  }
  add_random_forces(s.scene, rng);
  return s;
}

void expect_node_derivatives(const Problem& p, const NodePtr& model) {
  const NodeDataPtr data = model->createData(), other = model->createData();
  model->calc(data, p.x, p.u);
  model->calcDiff(data, p.x, p.u);
  const Eigen::Index n = data->Fx.cols(), m = data->Fu.cols();
  for (Eigen::Index c = 0; c < n + m; ++c) {
    SCOPED_TRACE("column " + std::to_string(c));
    Eigen::VectorXd dx = Eigen::VectorXd::Zero(n), du = Eigen::VectorXd::Zero(m);
    (c < n ? dx[c] : du[c - n]) = 1;
    const Eigen::VectorXd mine = c < n ? data->Fx.col(c) : data->Fu.col(c - n);
    double error = kInfinity, size = 0;  // of the better of two differences: rounding in one, a remainder in the other
    for (const double e : {1e-3, 1e-4}) {
      const Eigen::VectorXd twin = fourth_order(p, model, other, dx, du, e);
      error = std::min(error, difference_of(mine, twin));
      size = size_of(twin);
    }
    EXPECT_LT(error, 1e-7 * (1e-2 + size));
  }
}

TEST(AppliedForcesInNodes, DerivativesOfAllIntegrators) {
  for (const bool free : {false, true})
    for (int seed = 300; seed < 303; ++seed) {
      SCOPED_TRACE(std::to_string(seed) + (free ? " free" : ""));
      const Problem p = make_problem(pushed(seed, free));
      expect_node_derivatives(p, std::make_shared<IntegratedActionModelSymplectic>(p.model(), 1e-2));
      expect_node_derivatives(p, std::make_shared<IntegratedActionModelEuler>(p.model(), 1e-2));
      expect_node_derivatives(p, std::make_shared<IntegratedActionModelRK>(p.model(), RKType::four, 1e-2));
    }
}

TEST(AppliedForcesInNodes, SymplecticIsTheStep) {
  for (const bool free : {false, true})
    for (int seed = 300; seed < 306; ++seed) {
      SCOPED_TRACE(std::to_string(seed) + (free ? " free" : ""));
      RandomScene s = pushed(seed, free);
      s.scene.springs.clear(), s.scene.spring_index.clear();  // between points: nodes evaluate them at the start
      const Problem p = make_problem(s);
      if (p.u.size() != s.u.size()) continue;  // passive joints
      const auto model = std::make_shared<IntegratedActionModelSymplectic>(p.model(), 1e-2);
      const NodeDataPtr data = model->createData();
      model->calc(data, p.x, p.u);
      SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 1e-2);
      for (std::size_t c = 0; c < s.scene.contacts.size(); ++c) sim.dynamics.active[c] = s.scene.contacts[c].active;
      ASSERT_EQ(step(s.scene, p.u, sim), StepStatus::kOk);
      Eigen::VectorXd end(p.x.size());
      end << sim.q, sim.v;
      EXPECT_LT(difference_of(data->xnext, end), 1e-12 * (1 + size_of(end)));
    }
}

// Returns the name of a frame of the first robot, with the robot's name as prefix if there are others.
std::string frame_of(const Scene& scene) {
  const Robot& robot = scene.robots.front();
  return (scene.nrobots() > 1 ? robot.name + "/" : "") + robot.model->frames.back().name;
}

// Nothing wrenches during an impact, which takes no time.
TEST(AppliedForcesInNodes, ImpactsDoNotSeeThem) {
  const RandomScene s = pushed(311, false);
  Scene bare = s.scene;
  bare.wrenches.clear(), bare.springs.clear(), bare.joint_springs.clear();
  Eigen::VectorXd x(s.q.size() + s.v.size());
  x << s.q, s.v;
  Eigen::VectorXd next[2];
  Eigen::MatrixXd Fx[2];
  int k = 0;
  for (const Scene* scene : {static_cast<const Scene*>(&s.scene), static_cast<const Scene*>(&bare)}) {
    const auto state = std::make_shared<StateMultibody>(*scene);
    const auto impulses = std::make_shared<ImpulseModelMultiple>(state);
    impulses->addImpulse("hit",
                         std::make_shared<ImpulseModel6D>(state, state->get_model()->getFrameId(frame_of(*scene))));
    ActionModelImpulseFwdDynamics model(state, impulses, std::make_shared<CostModelSum>(state, 0));
    const NodeDataPtr data = model.createData();
    for (int again = 0; again < 2; ++again) {
      model.calc(data, x, Eigen::VectorXd(0));
      model.calcDiff(data, x, Eigen::VectorXd(0));
    }
    next[k] = data->xnext;
    Fx[k++] = data->Fx;
  }
  EXPECT_LE(difference_of(next[0], next[1]), 1e-12 * size_of(next[1]));
  EXPECT_LE(difference_of(Fx[0], Fx[1]), 1e-11 * size_of(Fx[1]));
}

}  // namespace
}  // namespace manycontact::test
