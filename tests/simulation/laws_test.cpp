// Energy and momentum, which the equations conserve, change only by the integrators' error, with its order.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "simulation/scenes.hpp"

namespace manycontact::test {
namespace {

using Broken = std::function<double(const RandomScene&, const SimulationData&)>;

// Expects a violation of the integrator's order, and a small one.
void expect_kept(const RandomScene& s, double time, int steps, double most, const Broken& broken) {
  for (Integrator integrator : kIntegrators) {
    SCOPED_TRACE(to_string(integrator));
    const bool rk4 = integrator == Integrator::kRk4;
    const double coarse = broken(s, simulated(s, integrator, time, steps));
    const double fine = broken(s, simulated(s, integrator, time, 2 * steps));
    EXPECT_GE(std::log2(coarse / fine), rk4 ? 3.6 : 0.8) << coarse << " " << fine;
    EXPECT_LE(fine, rk4 ? most * most * most : most);
    EXPECT_GT(coarse, 1e-13);
  }
}

double energy_error(const RandomScene& s, const SimulationData& sim) {
  return std::abs(end_of(s, sim).energy() - start_of(s).energy()) / end_of(s, sim).kinetic;
}

TEST(SimulationLaws, HeldWithoutTorquesKeepsEnergy) {
  for (int seed : {11, 12, 13}) {
    SCOPED_TRACE(seed);
    RandomScene s = tied_scene(seed);
    s.u.setZero();
    expect_kept(s, 0.5, 256, 0.02, energy_error);
  }
  RandomScene humanoid = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/humanoid_standing.xml"));
  humanoid.u.setZero();
  expect_kept(humanoid, 0.3, 128, 0.05, energy_error);
}

double momentum_error(const RandomScene& s, const SimulationData& sim) {
  return error_of(end_of(s, sim).momentum, start_of(s).momentum);
}

TEST(SimulationLaws, FreeWithoutGravityKeepsMomentum) {
  for (int seed : {21, 22, 23}) {
    SCOPED_TRACE(seed);
    RandomScene s = free_scene(seed);
    s.scene.gravity.setZero();
    const auto by = [&](Integrator integrator, int steps) {
      return momentum_error(s, simulated(s, integrator, 0.5, steps));
    };
    EXPECT_LE(by(Integrator::kSemiImplicitEuler, 256), 1e-12);  // see simulation/momentum.hpp
    EXPECT_GE(std::log2(by(Integrator::kRk4, 256) / by(Integrator::kRk4, 512)), 3.6);
    EXPECT_LE(by(Integrator::kRk4, 512), 8e-6);
  }
}

// Gravity changes the linear momentum by exactly m g t with every integrator, except for the error of tumbling.
TEST(SimulationLaws, FreeFallGainsMomentum) {
  RandomScene s = free_scene(24);
  const SimulationData sim = simulated(s, Integrator::kRk4, 0.2, 400);
  const Vec3<double> gained = (end_of(s, sim).momentum - start_of(s).momentum).head<3>();
  EXPECT_LE(error_of(gained, Vec3<double>(0.2 * s.scene.robots[0].model->mass() * s.scene.gravity)), 1e-7);
}

// Two humanoids and a beam collapse through a configuration where their loops lose a rank, at t = 0.35588 s. Steps
// small enough to hit it gain up to hundreds of J; with damping they do not.
TEST(SimulationLaws, DampingCarriesOverSingularConfigurations) {
  RandomScene s = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/two_humanoids_carry_beam.xml"));
  s.u.setZero();
  const SimulationData before = simulated(s, Integrator::kRk4, 0.3552, 888);
  s.q = before.q;
  s.v = before.v;
  const double start = start_of(s).energy();
  const auto error = [&](double damping) {
    s.scene.damping = damping;
    return std::abs(end_of(s, simulated(s, Integrator::kRk4, 0.0012, 120)).energy() - start);
  };
  EXPECT_LE(error(1e-6), 1e-3);
  EXPECT_GE(error(0), 10 * error(1e-6));
}

// Energy and momentum of `invariants` agree with those of the bodies' velocities.
TEST(Invariants, AreTheMechanics) {
  for (int seed : {31, 32, 33}) {
    const RandomScene s = tied_scene(seed);
    const Invariants at = start_of(s);
    const Mechanics m = mechanics(s.scene, s.q, s.v);
    EXPECT_NEAR(at.kinetic, m.kinetic, 1e-12 * m.kinetic);
    EXPECT_NEAR(at.potential, m.potential, 1e-12 * std::abs(m.potential));
    EXPECT_LE(error_of(Vec3<double>(at.momentum.head<3>()), m.linear), 1e-12);
    EXPECT_LE(error_of(Vec3<double>(at.momentum.tail<3>()), m.angular), 1e-12);
    EXPECT_GT(m.angular.norm(), 1e-3);
  }
}

// The constraint violation of a displaced box is known for each type of contact.
TEST(Invariants, DriftIsTheContactsError) {
  const auto drift = [](const std::string& contact) {
    const SceneFile file = load_text(
        "<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\" xyz=\"0.1 0.2 0.3\"><v>1 2 -3 0.5 0 0</v></robot>"
        "<contact name=\"c\" frame=\"b/crate\" xyz=\"0 0 0\" quat_xyzw=\"0 0 0 1\" " +
        contact + "/></scene>");
    return start_of(of_file(file));
  };
  EXPECT_NEAR(drift("type=\"3d\"").violation_position, 0.3, 1e-15);
  EXPECT_NEAR(drift("type=\"3d\"").violation_velocity, 3, 1e-15);
  EXPECT_NEAR(drift("type=\"1d\" axis=\"0 1 0\"").violation_position, 0.2, 1e-15);
  EXPECT_NEAR(drift("type=\"1d\" axis=\"0 1 0\"").violation_velocity, 2, 1e-15);
  EXPECT_NEAR(drift("type=\"6d\"").violation_position, 0.3, 1e-15);
  EXPECT_EQ(drift("type=\"6d\" active=\"false\"").violation_position, 0.3);  // the caller's flag counts, not the file's
  InvariantsData room(load_text("<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/></scene>").scene);
  EXPECT_TRUE(room.contacts.empty());
}

}  // namespace
}  // namespace manycontact::test
