// Resisting forces are evaluated at the end of a step: dampers, PD laws, joint friction, springs that rotate.

#include <gtest/gtest.h>

#include <cmath>

#include "manycontact/algorithm/configuration.hpp"
#include "simulation/scenes.hpp"
#include "support/allocations.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

constexpr double kMass = 2;

// Returns a mass on a slide across gravity, with a damper and friction in its joint.
RandomScene slide(double damping, double friction, double v) {
  RandomScene s;
  Model model;
  Joint joint;
  joint.name = "slide";
  joint.type = JointType::kPrismatic;
  joint.axis = Vec3<double>::UnitX();
  joint.inertia = Inertia<double>::from_com(kMass, Vec3<double>::Zero(), Mat3<double>::Identity());
  joint.lower = joint.upper = joint.velocity_limit = joint.effort_limit = VectorXd::Zero(1);
  model.joints = {joint};
  model.frames = {{"mass", 0, {}, false, {}, "slide"}};
  model.damping = VectorXd::Constant(1, damping);
  model.friction = VectorXd::Constant(1, friction);
  finalize(model);
  add_robot(s.scene, "body", std::make_shared<const Model>(model));
  s.q = VectorXd::Zero(1);
  s.v = VectorXd::Constant(1, v);
  s.u = VectorXd::Zero(1);
  return s;
}

// The resistance is a damper or a spring in the joint, a PD law, or a damper or a spring to a point on its axis.
enum class By { kJoint, kPdLaw, kPoint };

// Returns the state with damping d and stiffness k towards q = 0, after a time in so many steps.
SimulationData resisted(By by, double d, double k, double q, double v, double time, int steps) {
  RandomScene s = slide(by == By::kJoint ? d : 0, 0, v);
  s.q[0] = q;
  if (by == By::kJoint && k > 0) s.scene.joint_springs.push_back({0, 0, k, 0});
  if (by == By::kPoint) {
    Spring spring{"s", {0, 0, {}}, {-1, -1, {Mat3<double>::Identity(), Vec3<double>(-2, 0, 0)}}, k};
    spring.length = 2;
    spring.damping = d;
    add_spring(s.scene, spring);
  }
  SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, time / steps);
  const VectorXd one = VectorXd::Ones(1), none = VectorXd::Zero(1);
  if (by == By::kPdLaw) sim.pd = {k * one, d * one, none, none};
  for (int n = 0; n < steps; ++n) EXPECT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
  return sim;
}

// v = v0 exp(-d t / m): the error falls at first order with the step, from h d / m = 1e-6 to 1e6, and energy falls.
TEST(Resisting, DampersOfAllSizes) {
  for (const By by : {By::kJoint, By::kPdLaw, By::kPoint})
    for (double ratio = 1e-6; ratio < 2e6; ratio *= 10)
      for (const double near : {0.999, 1.001}) {
        SCOPED_TRACE(std::to_string(static_cast<int>(by)) + " " + std::to_string(ratio * near));
        const double h = 1e-3, d = ratio * near * kMass / h;
        const SimulationData coarse = resisted(by, d, 0, 0, 3, 8 * h, 8), fine = resisted(by, d, 0, 0, 3, 8 * h, 16);
        const double run = 3 * kMass / d * -std::expm1(-d * 8 * h / kMass);
        const auto error = [&](const SimulationData& sim) { return std::abs(sim.q[0] - run); };
        EXPECT_LE(error(coarse), run * std::min(1.0, d * h / kMass) * 1.01 + 1e-15);
        if (ratio < 0.02) {
          EXPECT_NEAR(error(coarse) / error(fine), 2, 0.1);
        }
        EXPECT_NEAR(fine.v[0], 3 * std::pow(1 + d * h / 2 / kMass, -16), 1e-12);
        EXPECT_LE(std::abs(fine.v[0]), 3);
      }
}

// q = q0 cos(w t), from h^2 k / m = 1e-6 to 1e6: the error falls at first order where the step resolves the
// oscillation; unresolved oscillations come to rest, and nothing jumps in between.
TEST(Resisting, SpringsOfAllSizes) {
  constexpr int kSteps = 8;
  const double h = 1e-3, q0 = 0.1;
  for (const By by : {By::kJoint, By::kPdLaw, By::kPoint})
    for (double ratio = 1e-6; ratio < 2e6; ratio *= 10) {
      double last = NAN;
      for (const double near : {0.999, 1.001}) {
        SCOPED_TRACE(std::to_string(static_cast<int>(by)) + " " + std::to_string(ratio * near));
        const double k = ratio * near * kMass / (h * h), w = std::sqrt(k / kMass);
        const SimulationData coarse = resisted(by, 0, k, q0, 0, kSteps * h, kSteps),
                             fine = resisted(by, 0, k, q0, 0, kSteps * h, 2 * kSteps);
        double q = q0, v = 0;  // m (v+ - v) = -h k (q + h (v+ - s v)), s = 0 of PD laws
        const double z = h * h * w * w, s = by == By::kPdLaw ? 0 : 1 - z * z / ((1 + z) * (1 + z));
        for (int n = 0; n < kSteps; ++n) v = ((1 + s * z) * v - h * w * w * q) / (1 + z), q += h * v;
        EXPECT_NEAR(coarse.q[0], q, 1e-12 * q0);
        const auto error = [&](const SimulationData& sim) {
          return std::abs(sim.q[0] - q0 * std::cos(w * kSteps * h));
        };
        // A PD law is damped by exp(-h w^2 t / 2); a spring keeps its energy within h w / 2 while steps resolve it.
        EXPECT_LE(error(coarse), q0 * std::min(h * w * w * kSteps * h, 2.0));
        if (ratio < 2e-3) {
          EXPECT_NEAR(error(coarse) / error(fine), 2, 0.1);
        }
        const auto energy = [&](const SimulationData& sim) {
          return kMass * sim.v[0] * sim.v[0] / 2 + k * sim.q[0] * sim.q[0] / 2;
        };
        EXPECT_LE(energy(coarse), k * q0 * q0 / 2 * (1 + std::min(h * w, 1.0)));
        if (near > 1) {
          EXPECT_NEAR(coarse.q[0], last, 0.01 * q0);
        }
        last = coarse.q[0];
      }
    }
}

// The damper's work is the energy that the mass loses.
TEST(Resisting, WorkIsWhatTheStepDid) {
  for (const double d : {1.0, 1e3, 1e6}) {
    const RandomScene s = slide(d, 4, 3);
    SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 1e-3);
    for (int k = 0; k < 10; ++k) {
      const double before = kMass * sim.v[0] * sim.v[0] / 2;
      ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
      EXPECT_NEAR(sim.work.dampers + sim.work.friction, kMass * sim.v[0] * sim.v[0] / 2 - before, 1e-13 * before);
    }
  }
}

// Friction slows the sliding mass by F / m, stops it and keeps it at rest while motors apply less than F.
TEST(Resisting, FrictionSlidesAndSticks) {
  RandomScene s = slide(0, 4, 1);
  SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 1e-2);
  for (int k = 1; k <= 49; ++k) {
    ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
    EXPECT_NEAR(sim.v[0], 1 - 0.02 * k, 1e-12);
  }
  s.u[0] = 3.9;
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
  const double at = sim.q[0];
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
  EXPECT_NEAR(sim.q[0], at, 1e-5);
  s.u[0] = 6;
  ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
  EXPECT_NEAR(sim.v[0], 0.01, 1e-6);  // 6 - 4 N on 2 kg
  EXPECT_EQ(sim.unsettled, 0);
}

// A humanoid with more joint friction than its weight needs stays at rest, on its feet or in the air.
TEST(Resisting, RobotsStand) {
  for (const bool floats : {false, true}) {
    RandomScene s = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/humanoid_standing.xml"));
    Model model = *s.scene.robots[0].model;
    model.damping = VectorXd::Zero(model.nv);
    model.friction = VectorXd::Constant(model.nv, 1e4);
    model.friction.head<6>().setZero();
    s.scene.robots[0].model = std::make_shared<const Model>(model);
    s.u.setZero();
    s.v.setZero();
    if (floats)
      for (Contact& contact : s.scene.contacts) contact.active = false;
    const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 1, 100);
    EXPECT_LE((sim.q - s.q).tail(s.scene.nu).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_EQ(sim.unsettled, 0);
  }
}

// m (v+ - v) = h (kp (q_ref - q - h v+) + kd (v_ref - v+)) is satisfied for any gains.
TEST(Resisting, PdLawsAreTakenAtTheEnd) {
  const RandomScene s = slide(0, 0, 3);
  for (const double kp : {0.0, 100.0, 1e9})
    for (const double kd : {0.0, 10.0, 1e6}) {
      const double h = 1e-2;
      SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, h);
      const VectorXd one = VectorXd::Ones(1);
      sim.pd = {kp * one, kd * one, 0.5 * one, 2 * one};
      ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
      EXPECT_NEAR(sim.v[0], (kMass * 3 + h * kp * 0.5 + h * kd * 2) / (kMass + h * kd + h * h * kp), 1e-10);
      EXPECT_NEAR(sim.pd_torque[0], kMass * (sim.v[0] - 3) / h, 1e-5 * (1 + std::abs(sim.pd_torque[0])));
    }
  SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 1e-2);
  sim.pd.kp = VectorXd::Constant(1, -1);
  EXPECT_THROW((void)step(s.scene, s.u, sim), std::invalid_argument);
}

// Two links on one axis have a stiff spring stretched along it between them: it does not affect their common rotation.
TEST(Resisting, SpringsDoNotBrakeWhatTurns) {
  for (const bool floating : {true, false})
    for (const double length : {0.9, 0.0}) {
      RandomScene s;
      Model model;
      Joint root, along;
      root.name = "root";
      root.type = floating ? JointType::kFloating : JointType::kRevolute;
      root.axis = Vec3<double>::UnitZ();
      root.inertia = Inertia<double>::from_com(1, Vec3<double>::Zero(), Mat3<double>::Identity());
      root.lower = root.upper = root.velocity_limit = root.effort_limit = VectorXd::Zero(floating ? 6 : 1);
      along = root;
      along.name = "along";
      along.type = JointType::kRevolute;
      along.axis = Vec3<double>::UnitX();
      along.parent = 0;
      along.lower = along.upper = along.velocity_limit = along.effort_limit = VectorXd::Zero(1);
      model.floating_base = floating;
      model.joints = {root, along};
      model.frames = {{"a", 0, {}, false, {}, "root"}, {"b", 1, {}, false, {}, "along"}};
      finalize(model);
      add_robot(s.scene, "r", std::make_shared<const Model>(model));
      s.scene.gravity.setZero();
      add_spring(s.scene, {"spring", attach(s.scene, "r", "a", {Mat3<double>::Identity(), {-0.5, 0, 0}}),
                           attach(s.scene, "r", "b", {Mat3<double>::Identity(), {0.5, 0, 0}}), 1e6, length});
      s.q = neutral(s.scene);
      s.v = VectorXd::Zero(s.scene.nv);
      s.v[floating ? 5 : 0] = 1;
      s.u = VectorXd::Zero(s.scene.nu);
      const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 1, 100);
      // In a rotation by x = 0.01 rad a step keeps 1 / (1 + x^4).
      EXPECT_NEAR(sim.v[floating ? 5 : 0], 1, 100 * 1e-8);
      EXPECT_NEAR(floating ? 2 * std::asin(sim.q[5]) : sim.q[0], 1, 100 * 1e-8);
    }
}

// A rotor that turns by 0.25 rad in a step goes on beside a soft spring, in a joint or between points.
TEST(Resisting, SoftSpringsDoNotBrakeRotors) {
  for (const bool in_joint : {true, false}) {
    RandomScene s;
    Model model;
    const Vec3<double> axes[3] = {Vec3<double>::UnitZ(), Vec3<double>::UnitY(), Vec3<double>::UnitX()};
    for (int k = 0; k < 3; ++k) {
      Joint joint;
      joint.name = "j" + std::to_string(k);
      joint.type = JointType::kRevolute;
      joint.axis = axes[k];
      joint.parent = k - 1;
      joint.placement.p = {k == 0 ? 0.0 : 0.4 / k, 0, 0};
      joint.inertia = Inertia<double>::from_com(1.0 / (k + 1), {k == 2 ? 0 : 0.2, 0, 0},
                                                Vec3<double>(0.002, 0.001, 0.001).asDiagonal());
      joint.lower = joint.upper = joint.velocity_limit = joint.effort_limit = VectorXd::Zero(1);
      model.joints.push_back(joint);
    }
    finalize(model);
    add_robot(s.scene, "r", std::make_shared<const Model>(model));
    s.scene.gravity.setZero();
    if (in_joint)
      add_joint_spring(s.scene, "r", "j1", 1, 0.2);
    else
      add_spring(s.scene, {"soft", {0, 1, {}}, {-1, -1, {Mat3<double>::Identity(), {0.3, 0.2, 0.1}}}, 1e-6, 0.1});
    s.q = Vec3<double>(0, 0.2, 0), s.v = Vec3<double>(1, 0.5, 250), s.u = VectorXd::Zero(s.scene.nu);
    const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 0.5, 500),
                         truth = simulated(s, Integrator::kRk4, 0.5, 2000);
    EXPECT_NEAR(sim.v[2], truth.v[2], 0.2);
    EXPECT_NEAR(end_of(s, sim).energy(), start_of(s).energy(), 1e-3 * start_of(s).energy());
  }
}

// Returns boxes in a chain of springs, without gravity, that rotate by up to a radian in a step.
RandomScene boxes_on_springs(int seed, double h, bool tied) {
  RandomScene s;
  std::mt19937 rng(static_cast<unsigned>(seed));
  s.scene.gravity.setZero();
  const int n = 2 + seed % 3;
  for (int r = 0; r < n; ++r) {
    Model model;
    Joint root;
    root.name = "root";
    root.type = JointType::kFloating;
    const Vec3<double> d = Vec3<double>::NullaryExpr([&] { return uniform(rng, 0.1, 0.5); });
    const Vec3<double> I = (d.squaredNorm() * Vec3<double>::Ones() - d.cwiseProduct(d)) / 12;
    root.inertia = Inertia<double>::from_com(1, Vec3<double>::Zero(), I.asDiagonal());
    root.lower = root.upper = root.velocity_limit = root.effort_limit = VectorXd::Zero(6);
    model.floating_base = true;
    model.joints = {root};
    model.frames = {{"box", 0, {}, false, {}, "root"}};
    finalize(model);
    add_robot(s.scene, "r" + std::to_string(r), std::make_shared<const Model>(model));
  }
  for (int r = tied ? 0 : 1; r < n; ++r) {
    Spring spring;
    spring.name = "s" + std::to_string(r);
    spring.A = {r, 0, random_placement(rng, 0.3)};
    spring.B =
        r == 0 ? Attachment{-1, -1, random_placement(rng, 0.3)} : Attachment{r - 1, 0, random_placement(rng, 0.3)};
    spring.stiffness = std::pow(10, uniform(rng, 0, 8));
    spring.length = 0.5 * (seed % 2);
    add_spring(s.scene, spring);
  }
  s.q = neutral(s.scene);
  for (int r = 0; r < n; ++r) s.q[7 * r] = 0.6 * r;
  s.v = VectorXd::NullaryExpr(s.scene.nv, [&] { return uniform(rng, -1, 1); }) * std::pow(10, uniform(rng, -2, 0)) / h;
  s.u = VectorXd::Zero(0);
  return s;
}

// Bodies rotate far in a step under springs of any stiffness: they do not gain kinetic energy beyond the start's total,
// and free ones keep their momentum.
TEST(Resisting, SpringsDoNotDriveWhatTurnsFar) {
  for (const bool tied : {false, true})
    for (int seed = 0; seed < 40; ++seed) {
      SCOPED_TRACE((tied ? "tied " : "free ") + std::to_string(seed));
      const RandomScene s = boxes_on_springs(seed, 1e-2, tied);
      const Invariants first = start_of(s);
      SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 1e-2);
      for (int k = 0; k < 100; ++k) {
        ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk) << k;
        ASSERT_LE(end_of(s, sim).kinetic, 1.5 * first.energy()) << k;
      }
      if (!tied) {
        EXPECT_LE(error_of(end_of(s, sim).momentum, first.momentum), 1e-9);
      }
      if (MANYCONTACT_COUNTS_ALLOCATIONS) {
        EXPECT_EQ(allocations([&] { (void)step(s.scene, s.u, sim); }), 0u);
      }
    }
}

}  // namespace
}  // namespace manycontact::test
