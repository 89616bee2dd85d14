// Redundant consistent contacts stay `redundant` in steps and impacts, where rows request velocities of rounding size.

#include <gtest/gtest.h>

#include "manycontact/simulation/gains.hpp"
#include "manycontact/simulation/switch.hpp"
#include "simulation/scenes.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

// At rest under its torques, with and without gains, all velocities and errors are rounding error.
TEST(Redundant, StandsOnItsCorners) {
  for (bool gains : {true, false})
    for (double h : {1e-2, 1e-3, 1e-4}) {
      RandomScene s = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/feet_on_corners.xml"));
      const Gains g = recommended_gains(Integrator::kSemiImplicitEuler, h);
      if (gains) set_gains(s.scene, g.alpha, g.beta);
      const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 200 * h, 200);
      EXPECT_EQ(sim.worst, Status::kRedundant) << gains << " " << h;
    }
}

// Feet land on their corners at any velocity, with gravity and without.
TEST(Redundant, ImpactsAtAnyVelocity) {
  int judged = 0;
  for (int seed = 0; seed < 30; ++seed) {
    RandomScene s = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/feet_on_corners.xml"));
    std::mt19937 rng(seed);
    s.v = std::pow(10.0, uniform(rng, -12, 2)) * random_vector(s.scene.nv, rng);
    if (seed % 2) s.scene.gravity.setZero();
    SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 1e-3);
    sim.dynamics.active.assign(s.scene.contacts.size(), 0);
    const VelocityJump jump = switch_contacts(s.scene, std::vector<char>(s.scene.contacts.size(), 1), sim);
    EXPECT_EQ(jump.status, Status::kRedundant) << seed;
    ++judged;
  }
  EXPECT_EQ(judged, 30);
}

// Inconsistent contacts are reported in steps too: one foot has two references.
TEST(Redundant, TwoPlacesOfOneFootAreInconsistent) {
  RandomScene s = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/feet_on_corners.xml"));
  const Gains g = recommended_gains(Integrator::kSemiImplicitEuler, 1e-3);
  set_gains(s.scene, g.alpha, g.beta);
  s.scene.contacts[0].B.placement.p[0] += 1e-6;
  const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 1e-2, 10);
  EXPECT_EQ(sim.worst, Status::kInconsistent);
}

}  // namespace
}  // namespace manycontact::test
