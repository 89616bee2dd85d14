// A step allocates nothing after the first, reports its failures, and gives the same bits twice.

#include "manycontact/simulation/step.hpp"

#include <gtest/gtest.h>

#include "simulation/scenes.hpp"
#include "support/allocations.hpp"

namespace manycontact::test {
namespace {

TEST(Step, AllocatesNothingAfterTheFirst) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  for (const char* name : {"two_humanoids_carry_beam", "quadruped_loop", "arm_pushes_box"})
    for (Integrator integrator : kIntegrators) {
      SCOPED_TRACE(std::string(name) + " " + to_string(integrator));
      const SceneFile file = load_scene(MANYCONTACT_SOURCE_DIR "/models/" + std::string(name) + ".xml");
      SimulationData sim(file.scene, file.q, file.v, integrator, 1e-3, {Method::kSparseLdl, {}});
      InvariantsData room(file.scene);
      EXPECT_EQ(step(file.scene, file.u, sim), StepStatus::kOk);
      EXPECT_EQ(allocations([&] {
                  for (int k = 0; k < 10; ++k) {
                    if (step(file.scene, file.u, sim) != StepStatus::kOk) std::abort();
                    (void)invariants(file.scene, sim.dynamics.active, sim.q, sim.v, room);
                  }
                }),
                0u);
      EXPECT_EQ(sim.steps, 11);
      EXPECT_DOUBLE_EQ(sim.time(), 0.011);
    }
}

// A chain has resistance in joints and links: dampers and springs in joints, joint friction, springs and dampers
// between points on it. One solve suffices for forces in joints; two more, and one factor of them, suffice for any
// number of springs.
TEST(Step, SolvesAreCounted) {
  constexpr int kLinks = 40, kSteps = 5;
  ModelOptions chain;
  chain.njoints = kLinks;
  chain.types = {JointType::kRevolute};
  chain.branching = 0;
  chain.armature = 0.1;
  SceneOptions options;
  options.nrobots = 1;
  options.ncontacts = 0;
  options.models = {chain};
  const auto solves = [&](double damping, double stiffness, double friction, int springs) {
    std::mt19937 rng(9);
    RandomScene s = random_scene(rng, options);
    Model model = *s.scene.robots[0].model;
    model.damping = Eigen::VectorXd::Constant(model.nv, damping);
    model.friction = Eigen::VectorXd::Constant(model.nv, friction);
    s.scene.robots[0].model = std::make_shared<const Model>(model);
    for (int i = 0; stiffness > 0 && i < kLinks; ++i) s.scene.joint_springs.push_back({0, i, stiffness, 0});
    for (int i = 0; i < springs; ++i) {
      Spring spring{"s" + std::to_string(i), {0, i % kLinks, {}}, {-1, -1, random_placement(rng, 3)}, 0.1};
      spring.length = 100;  // compressed: it has no stiffness across
      spring.damping = 1;
      add_spring(s.scene, spring);
    }
    s.v.setZero(), s.u.setZero();
    SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 1e-3);
    EXPECT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
    const long first = sim.solves;
    for (int k = 0; k < kSteps; ++k) EXPECT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
    EXPECT_EQ((sim.solves - first) % kSteps, 0);
    return (sim.solves - first) / kSteps;
  };
  EXPECT_EQ(solves(0, 0, 0, 0), 1);
  EXPECT_EQ(solves(1, 0, 0, 0), 1);
  EXPECT_EQ(solves(1e6, 1e6, 0, 0), 1);
  EXPECT_EQ(solves(1, 1, 1e4, 0), 1);  // every joint sticks, as in the step before
  EXPECT_EQ(solves(1, 0, 0, 3), 2 + 3);
  EXPECT_EQ(solves(1, 0, 0, 40), 3);
  EXPECT_EQ(solves(1, 0, 0, 80), 3);
}

TEST(Step, TheSameBitsTwice) {
  for (Integrator integrator : kIntegrators) {
    const RandomScene s = tied_scene(51);
    const SimulationData once = simulated(s, integrator, 0.1, 100), twice = simulated(s, integrator, 0.1, 100);
    EXPECT_TRUE(once.q == twice.q);
    EXPECT_TRUE(once.v == twice.v);
    EXPECT_GT(difference_of(once.q, s.q), 1e-3);
  }
}

// With gains far beyond the limit the run ends, reports this, and keeps the last good state.
TEST(Step, DivergenceStops) {
  for (Integrator integrator : kIntegrators) {
    SCOPED_TRACE(to_string(integrator));
    RandomScene s = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/humanoid_hands_and_feet.xml"));
    set_gains(s.scene, 1e6, 2000);
    SimulationData sim(s.scene, s.q, s.v, integrator, 1e-2);
    StepStatus status = StepStatus::kOk;
    Eigen::VectorXd q, v;
    for (int k = 0; k < 1000 && status == StepStatus::kOk; ++k) {
      q = sim.q, v = sim.v;
      status = step(s.scene, s.u, sim);
    }
    EXPECT_NE(status, StepStatus::kOk);
    EXPECT_LT(sim.steps, 1000);
    EXPECT_TRUE(sim.q == q && sim.v == v);
    EXPECT_NE(failure(s.scene, sim, status), "");
  }
}

TEST(Step, SaysWhatWasTooFast) {
  const SceneFile file = load_text("<scene><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"/></scene>");
  SimulationData sim(file.scene, file.q, file.v, Integrator::kSemiImplicitEuler, 1e-3);
  Eigen::VectorXd u = file.u;
  u[3] = 1e9;
  EXPECT_EQ(step(file.scene, u, sim), StepStatus::kTooFast);
  EXPECT_NE(failure(file.scene, sim, StepStatus::kTooFast).find("a/"), std::string::npos);
  EXPECT_EQ(sim.steps, 0);
  EXPECT_TRUE(sim.q == file.q && sim.v == file.v);
  EXPECT_EQ(step(file.scene, file.u, sim), StepStatus::kOk);  // and continues
  EXPECT_EQ(failure(file.scene, sim, StepStatus::kOk), "");
}

TEST(Step, SaysThatTheSolverFailed) {
  const SceneFile file = load_text("<scene><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"/></scene>");
  for (Integrator integrator : kIntegrators) {
    SimulationData sim(file.scene, file.q, file.v, integrator, 1e-3);
    Eigen::VectorXd u = file.u;
    u[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(step(file.scene, u, sim), StepStatus::kSolverFailed);
    EXPECT_EQ(sim.worst, Status::kFailed);
    EXPECT_EQ(failure(file.scene, sim, StepStatus::kSolverFailed).find("the solver failed: "), 0u);
    EXPECT_TRUE(sim.q == file.q && sim.v == file.v);
  }
}

TEST(Step, RefusesWhatDoesNotFit) {
  const RandomScene s = free_scene(1);
  const Integrator euler = Integrator::kSemiImplicitEuler;
  const auto make = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v, double h) {
    SimulationData(s.scene, q, v, euler, h);
  };
  EXPECT_NO_THROW(make(s.q, s.v, 1e-3));
  EXPECT_THROW(make(s.v, s.v, 1e-3), std::invalid_argument);
  EXPECT_THROW(make(s.q, s.q, 1e-3), std::invalid_argument);
  for (double h : {0.0, -1e-3, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(make(s.q, s.v, h), std::invalid_argument);
  SimulationData sim(s.scene, s.q, s.v, euler, 1e-3);
  EXPECT_THROW((void)step(s.scene, Eigen::VectorXd::Zero(s.scene.nu + 1), sim), std::invalid_argument);
}

// Boxes coupled by hinges fall: across gravity all that a step solves for is rounding error, and no row is accurate
// relative to that. The dense reference solver, which takes a thousand times as long, is not used.
TEST(Step, WhatFallsIsJudgedBesideGravity) {
  const SceneFile file = load_text(R"(<scene name="falling">
    <robot name="b" urdf="box.urdf" base="floating" xyz="0 0 1" copies="300" arrange="line" spacing="0.5"/>
    <contact name="hinge" type="5d" frame="b/crate" to="b+1/crate" offset="0.25 0 0"/></scene>)");
  SimulationData sim(file.scene, file.q, file.v, Integrator::kSemiImplicitEuler, 1e-4);
  for (int k = 0; k < 6; ++k) {
    ASSERT_EQ(step(file.scene, file.u, sim), StepStatus::kOk);
    EXPECT_EQ(sim.dynamics.report.status, Status::kOk) << k;
    EXPECT_NE(sim.dynamics.report.islands[0].method, Method::kDense) << k;
    EXPECT_LE(sim.dynamics.report.backward_error, 1e-12) << k;
  }
  for (int k = 2; k < file.scene.nv; k += 6) EXPECT_NEAR(sim.v[k], -9.81 * 6e-4, 1e-12);
}

// Names are converted both ways.
TEST(Integrators, HaveNames) {
  for (Integrator integrator : kIntegrators) EXPECT_EQ(integrator_from_string(to_string(integrator)), integrator);
  EXPECT_FALSE(integrator_from_string("euler"));
}

}  // namespace
}  // namespace manycontact::test
