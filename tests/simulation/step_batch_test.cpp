// Many simulations of one scene run at once: each has the result of `step` alone.

#include "manycontact/simulation/step_batch.hpp"

#include "simulation/scenes.hpp"
#include "support/applied.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

BatchMatrix varied(const VectorXd& x, int states, double by, std::mt19937& rng) {
  BatchMatrix out(states, x.size());
  for (int k = 0; k < states; ++k)
    for (Eigen::Index i = 0; i < x.size(); ++i) out(k, i) = x[i] + by * uniform(rng, -1, 1);
  return out;
}

struct Herd {
  RandomScene s;
  BatchMatrix q, v, u;
};

// Returns robots with contacts, and optionally with wrenches, springs and friction in joints.
Herd herd(int seed, int states, bool with_forces) {
  Herd out{tied_scene(seed), {}, {}, {}};
  std::mt19937 rng(static_cast<unsigned>(seed));
  if (with_forces) {
    add_random_forces(out.s.scene, rng, 2, 3);
    for (Robot& robot : out.s.scene.robots) {
      Model model = *robot.model;
      model.damping = VectorXd::Constant(model.nv, 0.1);
      model.friction = VectorXd::Constant(model.nv, 0.05);
      model.damping.head<6>().setZero(), model.friction.head<6>().setZero();
      robot.model = std::make_shared<const Model>(model);
    }
  }
  out.q = out.s.q.transpose().replicate(states, 1);
  out.v = varied(out.s.v, states, 0.1, rng);
  for (int k = 0; k < states; ++k)
    out.v.row(k) = consistent(out.s.scene, out.s.q, out.v.row(k).transpose()).transpose();
  out.u = varied(out.s.u, states, 0.1, rng);
  return out;
}

TEST(StepBatch, EachIsStepped) {
  constexpr int kStates = 21, kSteps = 20;
  for (const bool with_forces : {false, true})
    for (const Integrator integrator : {Integrator::kSemiImplicitEuler, Integrator::kRk4}) {
      SCOPED_TRACE(to_string(integrator) + (with_forces ? " with forces" : ""));
      const Herd h = herd(3, kStates, with_forces);
      SimulationBatch batch(h.s.scene, h.q, h.v, integrator, 1e-3, 2);
      step_batch(h.s.scene, h.u, batch, kSteps / 2);
      step_batch(h.s.scene, h.u, batch, kSteps / 2);
      for (int k = 0; k < kStates; ++k) {
        SimulationData alone(h.s.scene, h.q.row(k).transpose(), h.v.row(k).transpose(), integrator, 1e-3);
        for (int n = 0; n < kSteps; ++n) ASSERT_EQ(step(h.s.scene, h.u.row(k).transpose(), alone), StepStatus::kOk);
        EXPECT_EQ(batch.status[static_cast<std::size_t>(k)], StepStatus::kOk);
        EXPECT_LE((batch.q.row(k).transpose() - alone.q).cwiseAbs().maxCoeff(), 1e-11) << k;
        EXPECT_LE((batch.v.row(k).transpose() - alone.v).cwiseAbs().maxCoeff(), 1e-9) << k;
        EXPECT_LE((batch.f.row(k).transpose() - alone.f).cwiseAbs().maxCoeff(),
                  1e-6 * (1 + alone.f.cwiseAbs().maxCoeff()));
      }
    }
}

// Robots whose M v, bias and contact velocities SIMD batches compute move as without them.
TEST(StepBatch, RobotsAloneMoveAsWithoutSimdBatches) {
  constexpr int kSteps = 30;
  Options plain;
  plain.simd_level = SimdLevel::kOff;
  for (const bool with_forces : {false, true})
    for (const bool with_laws : {false, true}) {
      SCOPED_TRACE(std::string(with_forces ? "with forces" : "") + (with_laws ? " with PD laws" : ""));
      Herd h = herd(8, 1, false);
      for (Contact& contact : h.s.scene.contacts) contact.alpha = 50, contact.beta = 10;
      h.s.scene.contacts.erase(h.s.scene.contacts.begin());  // the one that couples the robots
      Scene scene = h.s.scene;
      scene.contacts.clear(), scene.contact_index.clear();
      for (const Contact& contact : h.s.scene.contacts) add_contact(scene, contact);
      std::mt19937 rng(8);
      if (with_forces) {
        add_random_forces(scene, rng, 2, 0);
        for (Robot& robot : scene.robots) {
          Model model = *robot.model;
          model.damping = VectorXd::Constant(model.nv, 0.1), model.friction = VectorXd::Constant(model.nv, 0.05);
          model.damping.head<6>().setZero(), model.friction.head<6>().setZero();
          robot.model = std::make_shared<const Model>(model);
        }
      }
      SimulationData batched(scene, h.s.q, h.s.v, Integrator::kSemiImplicitEuler, 1e-3),
          alone(scene, h.s.q, h.s.v, Integrator::kSemiImplicitEuler, 1e-3, plain);
      for (SimulationData* d : {&batched, &alone}) {
        if (with_laws) {
          d->pd.kp = VectorXd::Zero(scene.nv);
          d->pd.kd = VectorXd::Constant(scene.nv, 2);
          d->pd.q_ref = d->pd.v_ref = VectorXd::Zero(scene.nv);
        }
        for (int n = 0; n < kSteps; ++n) ASSERT_EQ(step(scene, h.s.u, *d), StepStatus::kOk);
      }
      EXPECT_TRUE(batched.in_batches);
      EXPECT_FALSE(alone.in_batches);
      EXPECT_LE((batched.q - alone.q).cwiseAbs().maxCoeff(), 1e-11);
      EXPECT_LE((batched.v - alone.v).cwiseAbs().maxCoeff(), 1e-9);
      EXPECT_LE((batched.f - alone.f).cwiseAbs().maxCoeff(), 1e-6 * (1 + alone.f.cwiseAbs().maxCoeff()));
      EXPECT_LE((batched.contact_v - alone.contact_v).cwiseAbs().maxCoeff(), 1e-9);
    }
}

// Rows are dependent, and one state is set again in between.
TEST(StepBatch, RowsThatDependDoSoStateByState) {
  constexpr int kStates = 11, kSteps = 10, kAnew = 3;
  for (const Integrator integrator : {Integrator::kSemiImplicitEuler, Integrator::kRk4}) {
    Herd h = herd(7, kStates, false);
    Contact again = h.s.scene.contacts[1];
    again.name = "grounded again";
    add_contact(h.s.scene, again);
    SimulationBatch batch(h.s.scene, h.q, h.v, integrator, 1e-3, 2);
    step_batch(h.s.scene, h.u, batch, kSteps);
    set_state(h.s.scene, kAnew, h.q.row(kAnew).transpose(), h.v.row(kAnew).transpose(), batch);
    step_batch(h.s.scene, h.u, batch, kSteps);
    for (int k = 0; k < kStates; ++k) {
      SimulationData alone(h.s.scene, h.q.row(k).transpose(), h.v.row(k).transpose(), integrator, 1e-3);
      for (int n = 0; n < (k == kAnew ? kSteps : 2 * kSteps); ++n)
        ASSERT_EQ(step(h.s.scene, h.u.row(k).transpose(), alone), StepStatus::kOk);
      EXPECT_EQ(alone.worst, Status::kRedundant);
      EXPECT_LE((batch.q.row(k).transpose() - alone.q).cwiseAbs().maxCoeff(), 1e-11) << k;
      EXPECT_LE((batch.v.row(k).transpose() - alone.v).cwiseAbs().maxCoeff(), 1e-9) << k;
    }
  }
}

// A state that is not finite or too fast stops alone, and continues from another state.
TEST(StepBatch, OneThatFailsStopsAlone) {
  constexpr int kStates = 11, kBad = 5;
  Herd h = herd(4, kStates, false);
  const BatchMatrix first = h.v;
  SimulationBatch batch(h.s.scene, h.q, h.v, Integrator::kSemiImplicitEuler, 1e-3);
  step_batch(h.s.scene, h.u, batch, 3);
  BatchMatrix u = h.u;
  u.row(kBad).setConstant(1e12);
  step_batch(h.s.scene, u, batch, 5);
  for (int k = 0; k < kStates; ++k) {
    EXPECT_EQ(batch.status[static_cast<std::size_t>(k)] == StepStatus::kOk, k != kBad) << k;
    SimulationData alone(h.s.scene, h.q.row(k).transpose(), first.row(k).transpose(), Integrator::kSemiImplicitEuler,
                         1e-3);
    for (int n = 0; n < (k == kBad ? 3 : 8); ++n)
      ASSERT_EQ(step(h.s.scene, h.u.row(k).transpose(), alone), StepStatus::kOk);
    EXPECT_LE((batch.v.row(k).transpose() - alone.v).cwiseAbs().maxCoeff(), 1e-9) << k;
  }
  set_state(h.s.scene, kBad, h.q.row(kBad).transpose(), first.row(kBad).transpose(), batch);
  step_batch(h.s.scene, h.u, batch);
  EXPECT_EQ(batch.status[kBad], StepStatus::kOk);
}

// A state that is set starts from scratch; the others continue with the velocities of their contacts.
TEST(StepBatch, StatesAreSetOneByOne) {
  constexpr int kStates = 8;
  const Herd h = herd(5, kStates, false);
  SimulationBatch batch(h.s.scene, h.q, h.v, Integrator::kSemiImplicitEuler, 1e-3);
  step_batch(h.s.scene, h.u, batch, 4);
  set_state(h.s.scene, 2, h.q.row(2).transpose(), h.v.row(2).transpose(), batch);
  step_batch(h.s.scene, h.u, batch, 4);
  for (int k = 0; k < kStates; ++k) {
    SimulationData alone(h.s.scene, h.q.row(k).transpose(), h.v.row(k).transpose(), Integrator::kSemiImplicitEuler,
                         1e-3);
    for (int n = 0; n < (k == 2 ? 4 : 8); ++n)
      ASSERT_EQ(step(h.s.scene, h.u.row(k).transpose(), alone), StepStatus::kOk);
    EXPECT_LE((batch.v.row(k).transpose() - alone.v).cwiseAbs().maxCoeff(), 1e-10) << k;
  }
}

TEST(StepBatch, RefusesWhatDoesNotFit) {
  const Herd h = herd(6, 3, false);
  const auto batch_of = [&](const BatchMatrix& q, double step) {
    return SimulationBatch(h.s.scene, q, h.v, Integrator::kRk4, step);
  };
  EXPECT_THROW((void)batch_of(h.q.topRows(2), 1e-3), std::invalid_argument);
  EXPECT_THROW((void)batch_of(h.q, 0), std::invalid_argument);
  SimulationBatch batch = batch_of(h.q, 1e-3);
  EXPECT_THROW(step_batch(h.s.scene, h.u.topRows(2), batch), std::invalid_argument);
  batch.kp = VectorXd::Ones(2);
  EXPECT_THROW(step_batch(h.s.scene, h.u, batch), std::invalid_argument);
  EXPECT_THROW(set_state(h.s.scene, 3, h.q.row(0).transpose(), h.v.row(0).transpose(), batch), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
