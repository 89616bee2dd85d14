// StateMultibody satisfies the manifold's laws; Jacobians agree with differences; bounds and actuations are tested.

#include <gtest/gtest.h>

#include "action/problem.hpp"
#include "spatial/compare.hpp"

namespace manycontact::test {
namespace {

std::shared_ptr<StateMultibody> random_state(int seed) {
  std::mt19937 rng(seed);
  SceneOptions options;
  options.models = {ModelOptions{.floating_base = true}, ModelOptions{}};
  return std::make_shared<StateMultibody>(random_scene(rng, options).scene);
}

class State : public testing::TestWithParam<int> {
 protected:
  std::shared_ptr<StateMultibody> state = random_state(GetParam());
  Eigen::VectorXd x0 = state->rand(), x1 = state->rand();
  std::mt19937 rng{7};
  Eigen::VectorXd dx = random_vector(static_cast<int>(state->get_ndx()), rng, 0.5);

  // returns df/dd at d = 0 from central differences
  template <class F>
  Eigen::MatrixXd difference(F&& f) {
    const Eigen::Index n = state->get_ndx();
    Eigen::MatrixXd J(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::VectorXd h = 1e-5 * Eigen::VectorXd::Unit(n, i);
      J.col(i) = (f(h) - f(-h)) / 2e-5;
    }
    return J;
  }
};

TEST_P(State, DiffUndoesIntegrate) {
  const Eigen::VectorXd moved = state->integrate_x(x0, dx);
  EXPECT_LT(error_of(state->diff_dx(x0, moved), dx), 1e-12);
  EXPECT_LT(size_of(state->diff_dx(x0, x0)), 1e-14);
  const Eigen::VectorXd there = state->integrate_x(x0, state->diff_dx(x0, x1));
  EXPECT_LT(size_of(state->diff_dx(there, x1)), 1e-11);
}

TEST_P(State, JdiffIsTheDerivative) {
  const auto Js = state->Jdiff_Js(x0, x1);
  const auto J0 = difference([&](const Eigen::VectorXd& h) { return state->diff_dx(state->integrate_x(x0, h), x1); });
  const auto J1 = difference([&](const Eigen::VectorXd& h) { return state->diff_dx(x0, state->integrate_x(x1, h)); });
  EXPECT_LT(error_of(Js[0], J0), 1e-7);
  EXPECT_LT(error_of(Js[1], J1), 1e-7);
  EXPECT_TRUE(state->Jdiff_Js(x0, x1, second)[0] == Js[1]);
}

TEST_P(State, JintegrateIsTheDerivative) {
  const auto Js = state->Jintegrate_Js(x0, dx);
  const Eigen::VectorXd there = state->integrate_x(x0, dx);
  const auto by_x = difference([&](const Eigen::VectorXd& h) {
    return state->diff_dx(there, state->integrate_x(state->integrate_x(x0, h), dx));
  });
  const auto by_dx =
      difference([&](const Eigen::VectorXd& h) { return state->diff_dx(there, state->integrate_x(x0, dx + h)); });
  EXPECT_LT(error_of(Js[0], by_x), 1e-7);
  EXPECT_LT(error_of(Js[1], by_dx), 1e-7);
  Eigen::MatrixXd J1 = Js[0], J2 = Js[1];
  state->Jintegrate(x0, dx, J1, J2, both, addto);
  EXPECT_LT(error_of(J1, 2 * Js[0]), 1e-15);
  state->Jintegrate(x0, dx, J1, J2, both, rmfrom);
  EXPECT_LT(error_of(J2, Js[1]), 1e-14);
  Eigen::MatrixXd in = Eigen::MatrixXd::Random(state->get_ndx(), 5), out = in;
  state->JintegrateTransport(x0, dx, out, first);
  EXPECT_LT(error_of(out, Js[0] * in), 1e-13);
  out = in;
  state->JintegrateTransport(x0, dx, out, second);
  EXPECT_LT(error_of(out, Js[1] * in), 1e-13);
}

INSTANTIATE_TEST_SUITE_P(Seeds, State, testing::Range(1, 6));

TEST(StateOfAUrdf, HasItsLimits) {
  const SceneFile file = load_scene(std::string(MANYCONTACT_SOURCE_DIR) + "/models/humanoid_standing.xml");
  const StateMultibody state(file.scene);
  EXPECT_EQ(state.get_nx(), state.get_nq() + state.get_nv());
  EXPECT_TRUE(state.get_has_limits());
  const Joint& knee = file.scene.robots[0].model->joints.back();
  EXPECT_EQ(state.get_lb()[knee.idx_q], knee.lower[0]);
  EXPECT_EQ(state.get_ub()[state.get_nq() + knee.idx_v], knee.velocity_limit[0]);
  EXPECT_TRUE(std::isinf(state.get_lb()[0]));  // a floating base is free
  const Eigen::VectorXd x = state.rand();
  EXPECT_TRUE((x.array() >= state.get_lb().array()).all() && (x.array() <= state.get_ub().array()).all());
  EXPECT_EQ(state.zero()[6], 1);
}

TEST(StateOfAScene, KnowsFramesByName) {
  const SceneFile file = load_scene(std::string(MANYCONTACT_SOURCE_DIR) + "/models/two_humanoids_carry_beam.xml");
  const StateMultibody state(file.scene);
  const std::string robot = file.scene.robots[1].name, link = file.scene.robots[1].model->frames[3].name;
  const FrameIndex id = state.get_pinocchio()->getFrameId(robot + "/" + link);
  EXPECT_EQ(state.get_model()->frames[id].robot, 1);
  EXPECT_FALSE(state.get_model()->existFrame(link));  // the robot is ambiguous
  EXPECT_THROW(state.get_model()->getFrameId("nobody/" + link), std::invalid_argument);
  const StateMultibody alone(file.scene.robots[1].model);
  EXPECT_TRUE(alone.get_model()->existFrame(link));
  EXPECT_EQ(alone.get_model()->frames[alone.get_model()->getFrameId(link)].name, link);
}

// Joints, fixed ones too, are frames as in Pinocchio; Crocoddyl's own examples use them.
TEST(StateOfAScene, KnowsFramesByTheirJoints) {
  const SceneFile file = load_scene(std::string(MANYCONTACT_SOURCE_DIR) + "/models/two_humanoids_carry_beam.xml");
  const StateMultibody state(file.scene), alone(file.scene.robots[0].model);
  int joints = 0, fixed = 0;
  for (const Frame& frame : file.scene.robots[0].model->frames) {
    if (frame.parent_joint.empty()) continue;
    ++joints;
    fixed += frame.merged;
    const std::string robot = file.scene.robots[0].name + "/";
    EXPECT_EQ(state.get_model()->getFrameId(robot + frame.parent_joint),
              state.get_model()->getFrameId(robot + frame.name));
    EXPECT_EQ(alone.get_model()->getFrameId(frame.parent_joint), alone.get_model()->getFrameId(frame.name));
  }
  EXPECT_EQ(joints + 1, static_cast<int>(file.scene.robots[0].model->frames.size()));
  EXPECT_GT(fixed, 0);
}

TEST(Actuations, SelectCoordinates) {
  const SceneFile file = load_small(std::string(MANYCONTACT_SOURCE_DIR) + "/models/herd.xml");
  auto state = std::make_shared<StateMultibody>(file.scene);
  ActuationModelFloatingBase floating(state);
  ActuationModelFull full(state);
  EXPECT_EQ(floating.get_nu(), static_cast<std::size_t>(file.scene.nu));
  EXPECT_EQ(full.get_nu(), state->get_nv());
  const auto data = floating.createData();
  const Eigen::VectorXd u = Eigen::VectorXd::Random(file.scene.nu), x = state->zero();
  floating.calc(data, x, u);
  EXPECT_EQ(data->tau.head(6).norm(), 0);
  EXPECT_EQ(data->tau[6], u[0]);
  EXPECT_TRUE(data->dtau_du * u == data->tau);
  floating.commands(data, x, data->tau);
  EXPECT_TRUE(data->u == u);
  floating.torqueTransform(data, x, u);
  EXPECT_TRUE(data->Mtau * data->tau == u);
  EXPECT_FALSE(data->tau_set[0]);
  EXPECT_TRUE(data->tau_set[6]);
  const SceneFile arm = load_scene(std::string(MANYCONTACT_SOURCE_DIR) + "/models/arm_pushes_box.xml");
  const auto fixed = std::make_shared<StateMultibody>(arm.scene.robots[0].model);  // as with ActuationModelFull
  EXPECT_EQ(ActuationModelFloatingBase(fixed).get_nu(), fixed->get_nv());
}

}  // namespace
}  // namespace manycontact::test
