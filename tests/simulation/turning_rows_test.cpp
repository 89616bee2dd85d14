// 1D and 2D contacts whose point slides while their rows turn: a step constrains J v with both integrators, so that
// nothing adds energy.

#include <gtest/gtest.h>

#include "manycontact/analysis/findings.hpp"
#include "manycontact/simulation/gains.hpp"
#include "simulation/scenes.hpp"

namespace manycontact::test {
namespace {

// A body, or two that the contact joins, turning and sliding, and J v = 0.
RandomScene sliding(int seed, ContactType type, ReferenceFrame frame, bool between) {
  std::mt19937 rng(seed);
  SceneOptions options;
  options.nrobots = between ? 2 : 1;
  ModelOptions model;
  model.njoints = 3;
  model.floating_base = true;
  model.types = {JointType::kRevolute};
  options.models = {model};
  options.ncontacts = 0;
  RandomScene s = random_scene(rng, options);
  hold(s, "slides", type, {0, 0, random_placement(rng, 0.2)},
       between ? Attachment{1, 0, random_placement(rng, 0.2)} : Attachment{});
  Contact& contact = s.scene.contacts.back();
  contact.reference_frame = frame;
  contact.axis = random_vector(3, rng).normalized();
  s.scene.gravity.setZero();
  s.u.setZero();
  s.v = consistent(s.scene, s.q, 0.5 * s.v);
  return s;
}

constexpr ReferenceFrame kFrames[] = {ReferenceFrame::kLocal, ReferenceFrame::kWorld};

TEST(TurningRows, KeepEnergyAndVelocity) {
  for (int seed = 0; seed < 3; ++seed)
    for (const ContactType type : {ContactType::k1D, ContactType::k2D})
      for (const ReferenceFrame frame : kFrames)
        for (const bool between : {false, true}) {
          SCOPED_TRACE(std::to_string(seed) + (between ? " between" : "") + std::to_string(static_cast<int>(type)) +
                       std::to_string(static_cast<int>(frame)));
          RandomScene s = sliding(seed, type, frame, between);
          const Invariants start = start_of(s);
          ASSERT_LT(start.violation_velocity, 1e-10);
          const Invariants end = end_of(s, simulated(s, Integrator::kRk4, 0.2, 200));
          EXPECT_NEAR(end.energy(), start.energy(), 1e-7 * start.kinetic);
          EXPECT_LT(end.violation_velocity, 1e-7);
          const Invariants coarse = end_of(s, simulated(s, Integrator::kSemiImplicitEuler, 0.2, 200));
          const Invariants fine = end_of(s, simulated(s, Integrator::kSemiImplicitEuler, 0.2, 400));
          EXPECT_LT(std::abs(fine.energy() - start.energy()),
                    0.75 * std::abs(coarse.energy() - start.energy()) + 1e-6 * start.kinetic);
          EXPECT_LT(coarse.violation_velocity, 0.1);
        }
}

// Both integrators simulate the same contact, whose gains do not act along rows that turn.
TEST(TurningRows, AreTheSameInBothIntegrators) {
  for (int seed = 0; seed < 4; ++seed)
    for (const ContactType type : {ContactType::k1D, ContactType::k2D})
      for (const bool gains : {false, true}) {
        SCOPED_TRACE(std::to_string(seed) + (gains ? " with gains" : ""));
        RandomScene s = sliding(seed, type, ReferenceFrame::kLocal, seed % 2 == 1);
        const auto q_by = [&](Integrator integrator, int steps) {
          const Gains g = gains ? recommended_gains(Integrator::kSemiImplicitEuler, 0.2 / steps) : Gains{0, 0};
          set_gains(s.scene, g.alpha, g.beta);
          return simulated(s, integrator, 0.2, steps).q;
        };
        const Eigen::VectorXd truth = q_by(Integrator::kRk4, 200);
        const double coarse = (q_by(Integrator::kSemiImplicitEuler, 200) - truth).norm();
        const double fine = (q_by(Integrator::kSemiImplicitEuler, 800) - truth).norm();
        EXPECT_LT(fine, 0.35 * coarse + 1e-9);
        EXPECT_LT(coarse, 0.05);
      }
}

}  // namespace
}  // namespace manycontact::test
