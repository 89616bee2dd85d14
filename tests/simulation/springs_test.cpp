// Pushes and springs through time.

#include "manycontact/simulation/spring_steps.hpp"
#include "simulation/scenes.hpp"
#include "support/applied.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

// A mass of 2 kg on a spring of 50 N/m, across gravity, 0.1 m off its rest: 5 rad/s.
RandomScene oscillator(double damping = 0, double stiffness = 50) {
  RandomScene s;
  Model model;
  Joint joint;
  joint.name = "slide";
  joint.type = JointType::kPrismatic;
  joint.axis = Vec3<double>::UnitX();
  joint.inertia = Inertia<double>::from_com(2, Vec3<double>::Zero(), Mat3<double>::Identity());
  joint.lower = joint.upper = joint.velocity_limit = joint.effort_limit = VectorXd::Zero(1);
  model.joints = {joint};
  model.frames = {{"mass", 0, {}, false, {}, "slide"}};
  finalize(model);
  add_robot(s.scene, "body", std::make_shared<const Model>(model));
  add_spring(s.scene, {"spring",
                       attach(s.scene, "body", "mass"),
                       {-1, -1, {Mat3<double>::Identity(), {-2, 0, 0}}},
                       stiffness,
                       2,
                       damping});
  s.q = VectorXd::Constant(1, 0.1);
  s.v = s.u = VectorXd::Zero(1);
  return s;
}

TEST(Springs, MassOscillates) {
  const RandomScene s = oscillator();
  EXPECT_NEAR(start_of(s).potential, 0.5 * 50 * 0.01, 1e-15);
  const SimulationData fine = simulated(s, Integrator::kRk4, 1, 1000);
  EXPECT_NEAR(fine.q[0], 0.1 * std::cos(5.0), 1e-10);
  EXPECT_NEAR(fine.v[0], -0.5 * std::sin(5.0), 1e-9);
  EXPECT_NEAR(end_of(s, fine).energy(), 0.25, 1e-11);
  const SimulationData first = simulated(s, Integrator::kSemiImplicitEuler, 1, 1000);
  EXPECT_NEAR(first.q[0], 0.1 * std::cos(5.0), 1e-3);
}

// Semi-implicit Euler is symplectic: energy swings by O(h) and comes back, for a thousand periods.
TEST(Springs, EnergyIsKeptOverLongTimes) {
  const RandomScene s = oscillator();
  const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 1000, 100000);  // h omega = 0.05
  EXPECT_NEAR(end_of(s, sim).energy(), 0.25, 0.06 * 0.25);
}

TEST(Springs, DampersTakeEnergy) {
  const RandomScene s = oscillator(4);  // c / 2 m = 1 /s
  const SimulationData sim = simulated(s, Integrator::kRk4, 1, 1000);
  const double w = std::sqrt(24.0);
  EXPECT_NEAR(sim.q[0], 0.1 * std::exp(-1.0) * (std::cos(w) + std::sin(w) / w), 1e-10);
}

// Trees, floating bases, loops: what springs hold and bodies have together stays.
TEST(Springs, EnergyOfScenes) {
  for (const bool tied : {false, true}) {
    RandomScene s = tied ? tied_scene(5) : free_scene(3);
    std::mt19937 rng(4);
    add_random_forces(s.scene, rng, 0, 4);
    for (Spring& spring : s.scene.springs) spring.damping = 0;
    s.u.setZero();
    const double before = start_of(s).energy();
    const SimulationData coarse = simulated(s, Integrator::kRk4, 0.1, 100),
                         fine = simulated(s, Integrator::kRk4, 0.1, 200);
    const double error = std::abs(end_of(s, fine).energy() - before);
    EXPECT_LE(error, 1e-6 * start_of(s).kinetic);
    EXPECT_GT(std::abs(end_of(s, coarse).energy() - before), 8 * error);  // of fourth order
  }
}

// Two bodies in space, a spring between them: momentum stays to rounding, in steps that are far from exact.
TEST(Springs, MomentumOfBodiesOnASpring) {
  RandomScene s = free_scene(7);
  const RandomScene other = free_scene(8);
  add_robot(s.scene, "other", other.scene.robots[0].model);
  const auto join = [](VectorXd& x, const VectorXd& y) {
    const VectorXd both = (VectorXd(x.size() + y.size()) << x, y).finished();
    x = both;
  };
  join(s.q, other.q), join(s.v, other.v), join(s.u, other.u);
  s.scene.gravity.setZero();
  s.u.setZero();
  add_spring(s.scene, {"rope", {0, 2, {}}, {1, 3, {}}, 40, 0.2, 1});
  const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 0.2, 100);
  EXPECT_LE(error_of(end_of(s, sim).momentum, start_of(s).momentum), 1e-11);
  EXPECT_GT((sim.v - s.v).norm(), 0.1);
}

// A push on a body in space: momentum grows by force times time, exactly.
TEST(Pushes, MomentumGrows) {
  RandomScene s = free_scene(7);
  s.scene.gravity.setZero();
  s.u.setZero();
  Vec6<double> w = Vec6<double>::Zero();
  w.head<3>() << 1, 2, 3;
  add_push(s.scene, {"push", {0, 0, {Mat3<double>::Identity(), {0.1, 0, 0}}}, ReferenceFrame::kWorld, w});
  const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 0.2, 100);
  EXPECT_LE(difference_of(Vec3<double>(end_of(s, sim).momentum.head<3>()),
                          Vec3<double>(start_of(s).momentum.head<3>() + 0.2 * w.head<3>())),
            1e-12);
}

TEST(Pushes, ChangeBetweenSteps) {
  RandomScene s = oscillator(0, 0);
  add_push(s.scene, {"push", s.scene.springs[0].A});
  for (const Integrator integrator : kIntegrators) {
    SimulationData sim(s.scene, VectorXd::Zero(1), s.v, integrator, 0.01);
    for (int k = 0; k < 100; ++k) {
      sim.dynamics.pushes[0][0] = k < 50 ? 4 : 0;
      ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
    }
    EXPECT_NEAR(sim.v[0], 1, 1e-12);  // 4 N on 2 kg for half a second
  }
}

TEST(SpringSteps, OfAMass) {
  const auto largest = [](const RandomScene& s, Integrator integrator) {
    return shortest_spring_step(s.scene, {}, s.q, integrator).largest;
  };
  for (const double damping : {0.0, 4.0, 400.0}) {
    RandomScene s = oscillator(damping);
    s.q[0] = 1e-12;  // as far as it grows, the spring stays about as long as it is
    for (const Integrator integrator : kIntegrators) {
      SCOPED_TRACE(to_string(integrator) + ", damping " + std::to_string(damping));
      const double most = largest(s, integrator);
      const auto growth = [&](double h) {  // of the energy, in 100 steps
        SimulationData sim(s.scene, s.q, s.v, integrator, h);
        sim.velocity_limit = 1e100;
        for (int k = 0; k < 100; ++k) EXPECT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
        return end_of(s, sim).energy() / start_of(s).energy();
      };
      EXPECT_LE(growth(0.98 * most), integrator == Integrator::kRk4 ? 1 + 1e-12 : 30);
      EXPECT_GT(growth((integrator == Integrator::kRk4 ? 1.3 : 1.05) * most), 100);
    }
  }
  EXPECT_NEAR(largest(oscillator(), Integrator::kSemiImplicitEuler), 0.4, 1e-12);  // 2 / omega
  RandomScene none = oscillator();
  none.scene.springs.clear();
  EXPECT_EQ(shortest_spring_step(none.scene, {}, none.q, Integrator::kRk4).spring, -1);
  add_joint_spring(none.scene, "body", "slide", 5000);
  const SpringStep step = shortest_spring_step(none.scene, {}, none.q, Integrator::kSemiImplicitEuler);
  EXPECT_TRUE(step.in_joint);
  EXPECT_NEAR(step.largest, 0.04, 1e-12);
}

}  // namespace
}  // namespace manycontact::test
