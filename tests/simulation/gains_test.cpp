// Gains have the effect of the linear maps, also on contacts of real scenes.

#include "manycontact/simulation/gains.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/scenes.hpp"

namespace manycontact::test {
namespace {

// Returns |e| + h |e'| after many steps of the integrator itself on e'' = -alpha e - beta e', from e = 1, h e' = hv; at
// most about 1e100.
double simulated_error(Integrator integrator, const Gains& gains, double h, int steps, double hv = 0) {
  const auto a = [&](double e, double v) { return -gains.alpha * e - gains.beta * v; };
  double e = 1, v = hv / h;
  for (int k = 0; k < steps && std::abs(e) + h * std::abs(v) < 1e100; ++k) {
    if (integrator == Integrator::kSemiImplicitEuler) {
      v += h * a(e, v);
      e += h * v;
      continue;
    }
    const double e1 = v, v1 = a(e, v), e2 = v + h / 2 * v1, v2 = a(e + h / 2 * e1, v + h / 2 * v1);
    const double e3 = v + h / 2 * v2, v3 = a(e + h / 2 * e2, v + h / 2 * v2);
    const double e4 = v + h * v3, v4 = a(e + h * e3, v + h * v3);
    e += h / 6 * (e1 + 2 * e2 + 2 * e3 + e4);
    v += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
  }
  return std::abs(e) + h * std::abs(v);
}

const std::vector<Gains> kSomeGains = {{25, 10},   {100, 20}, {1e4, 200}, {1, 50},   {400, 0},
                                       {2500, 10}, {0, 20},   {900, 60},  {1e-3, 2}, {3e3, 70}};

TEST(Gains, ErrorsGrowBeyondTheLimitOnly) {
  for (Integrator integrator : kIntegrators)
    for (const Gains& gains : kSomeGains) {
      SCOPED_TRACE(to_string(integrator) + " " + std::to_string(gains.alpha) + " " + std::to_string(gains.beta));
      const double limit = largest_stable_step(integrator, gains);
      ASSERT_TRUE(std::isfinite(limit));
      for (double part = 0.02; part < 1; part += 0.02)
        EXPECT_LE(error_growth(integrator, gains, part * limit), 1 + 1e-12) << part;
      EXPECT_GT(error_growth(integrator, gains, 1.001 * limit), 1 + 1e-6);
      EXPECT_LE(simulated_error(integrator, gains, 0.999 * limit, 20000, 1), 1e3);
      EXPECT_GT(simulated_error(integrator, gains, 1.01 * limit, 20000, 1), 1e6);
    }
}

TEST(Gains, LimitsOfSimpleGains) {
  const Integrator euler = Integrator::kSemiImplicitEuler, rk4 = Integrator::kRk4;
  EXPECT_NEAR(largest_stable_step(euler, {4, 0}), 1, 1e-15);                       // 2 / omega
  EXPECT_NEAR(largest_stable_step(euler, {0, 4}), 0.5, 1e-15);                     // 2 / beta
  EXPECT_NEAR(largest_stable_step(euler, {1, 2}), 2 * (std::sqrt(2) - 1), 1e-15);  // critically damped
  EXPECT_NEAR(largest_stable_step(rk4, {1, 2}), 2.785293563, 1e-8);
  EXPECT_NEAR(largest_stable_step(rk4, {1, 0}), 2 * std::sqrt(2), 1e-6);
  for (Integrator integrator : kIntegrators) {
    EXPECT_EQ(largest_stable_step(integrator, {0, 0}), std::numeric_limits<double>::infinity());
    EXPECT_EQ(largest_stable_step(integrator, {-1, 2}), 0);
    EXPECT_EQ(largest_stable_step(integrator, {1, -2}), 0);
    EXPECT_DOUBLE_EQ(error_growth(integrator, {0, 0}, 0.1), 1);
  }
  EXPECT_NEAR(error_growth(euler, {1e4, 100}, 0.01), 0, 1e-15);  // deadbeat
}

TEST(Gains, RecommendedShrinkErrorsAsTheySay) {
  for (double h : {1e-4, 1e-2, 1.0}) {
    const Integrator euler = Integrator::kSemiImplicitEuler, rk4 = Integrator::kRk4;
    EXPECT_NEAR(error_growth(euler, recommended_gains(euler, h), h), 0.5, 1e-7);
    EXPECT_NEAR(error_growth(rk4, recommended_gains(rk4, h), h), std::exp(-0.1), 1e-7);
    EXPECT_NEAR(largest_stable_step(euler, recommended_gains(euler, h)), 2 * h, 1e-12 * h);
    EXPECT_NEAR(largest_stable_step(rk4, recommended_gains(rk4, h)), 27.85293563 * h, 1e-6 * h);
  }
  for (double h : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW((void)recommended_gains(Integrator::kRk4, h), std::invalid_argument);
}

// ---- real scenes: torques nearly balance them, contacts start off their references ---------------------------------

struct Ran {
  double start, end, largest;  // position drift
  StepStatus stopped;
};

Ran run(RandomScene s, Integrator integrator, const Gains& gains, double h, int steps) {
  set_gains(s.scene, gains.alpha, gains.beta);
  SimulationData sim(s.scene, s.q, s.v, integrator, h, {Method::kSparseLdl, {}});
  Ran out{start_of(s).violation_position, 0, 0, StepStatus::kOk};
  out.largest = out.start;
  InvariantsData room(s.scene);
  for (int k = 0; k < steps && out.stopped == StepStatus::kOk; ++k) {
    out.stopped = step(s.scene, s.u, sim);
    out.end = invariants(s.scene, sim.dynamics.active, sim.q, sim.v, room).violation_position;
    out.largest = std::max(out.largest, out.end);
  }
  return out;
}

// Returns a standing humanoid, two humanoids and a beam, a humanoid on hands and feet; each with errors of about 1e-5.
std::vector<RandomScene> standing() {
  std::vector<RandomScene> out;
  for (const char* name : {"humanoid_standing", "two_humanoids_carry_beam", "humanoid_hands_and_feet"}) {
    RandomScene s = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/" + std::string(name) + ".xml"));
    s.v.setZero();
    std::mt19937 rng(41);
    for (Contact& c : s.scene.contacts) {
      c.reference_frame = ReferenceFrame::kLocal;
      if (c.B.robot < 0) c.B.placement.p += random_vector(3, rng, 1e-5);
    }
    out.push_back(s);
  }
  return out;
}

TEST(GainsOnScenes, DriftDecaysAsPredicted) {
  for (const RandomScene& s : standing())
    for (Integrator integrator : kIntegrators) {
      SCOPED_TRACE(s.scene.robots[0].name + " " + to_string(integrator));
      const double h = 1e-3;
      const bool rk4 = integrator == Integrator::kRk4;
      const Gains gains = recommended_gains(integrator, h);
      const int steps = rk4 ? 60 : 10;
      const Ran ran = run(s, integrator, gains, h, steps);
      const double predicted = simulated_error(integrator, gains, h, steps);
      EXPECT_EQ(ran.stopped, StepStatus::kOk);
      EXPECT_GT(ran.start, 1e-6);
      EXPECT_LT(predicted, 0.03);
      EXPECT_LE(ran.end, 2 * predicted * ran.start);
      const Ran bare = run(s, integrator, {}, h, steps);
      EXPECT_GT(bare.end, 0.5 * bare.start);
    }
}

TEST(GainsOnScenes, BlowUpJustBeyondTheLimitOnly) {
  for (const RandomScene& s : standing())
    for (Integrator integrator : kIntegrators) {
      SCOPED_TRACE(s.scene.robots[0].name + " " + to_string(integrator));
      const Gains stiff{1e6, 2000};
      const double limit = largest_stable_step(integrator, stiff);
      const Ran inside = run(s, integrator, stiff, 0.95 * limit, 150),
                beyond = run(s, integrator, stiff, 1.05 * limit, 150);
      EXPECT_EQ(inside.stopped, StepStatus::kOk);
      EXPECT_LE(inside.largest, 20 * inside.start);  // RK4: stiff gains cause this violation, not the start's error
      if (integrator == Integrator::kSemiImplicitEuler) {
        EXPECT_LE(inside.end, 0.1 * inside.start);
      }
      EXPECT_TRUE(beyond.stopped != StepStatus::kOk || beyond.largest > 1000 * beyond.start) << beyond.largest;
    }
}

// RK4 is less accurate with gains near the limit than with a tenth of it, as the header states.
TEST(GainsOnScenes, StiffGainsCostRk4ItsOrder) {
  RandomScene s = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/humanoid_standing.xml"));
  s.u.setZero();
  const auto drift = [&](double h_omega, double h) {
    const double omega = h_omega / h;
    return run(s, Integrator::kRk4, {omega * omega, 2 * omega}, h, static_cast<int>(std::round(0.2 / h))).largest;
  };
  EXPECT_GT(drift(1.39, 1e-3), 50 * drift(0.1, 1e-3));
  EXPECT_NEAR(std::log2(drift(1.39, 2e-3) / drift(1.39, 1e-3)), 2, 0.5);
}

}  // namespace
}  // namespace manycontact::test
