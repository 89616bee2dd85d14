// The order of the integrators, against a fine run of another one: quaternions by their own derivative, classical RK4.

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/scenes.hpp"

namespace manycontact::test {
namespace {

// |q - q'| on the manifold and |v - v'|, the larger of both.
double distance(const Scene& scene, const SimulationData& sim, const Simulation& truth) {
  double largest = difference_of(sim.v, truth.v);
  for (const Robot& r : scene.robots) {
    Eigen::VectorXd d(r.model->nv);
    difference<double>(*r.model, truth.q.segment(r.idx_q, r.model->nq), sim.q.segment(r.idx_q, r.model->nq), d);
    largest = std::max(largest, size_of(d));
  }
  return largest;
}

struct Case {
  std::string name;
  RandomScene scene;
  double time;
  int steps;  // the coarser run's
};

std::vector<Case> cases() {
  std::vector<Case> out;
  for (int seed : {1, 2, 3}) out.push_back({"free " + std::to_string(seed), free_scene(seed), 0.2, 64});
  out.push_back({"free on a fixed base", free_scene(4, false), 0.2, 64});
  for (int seed : {5, 6}) {
    RandomScene tied = tied_scene(seed);
    out.push_back({"tied " + std::to_string(seed), tied, 0.2, 64});
    set_gains(tied.scene, 100, 20);
    out.push_back({"tied with gains " + std::to_string(seed), tied, 0.2, 64});
  }
  out.push_back({"tied, floating joints inside",
                 tied_scene(7, {JointType::kRevolute, JointType::kFloating, JointType::kPlanar}), 0.2, 64});
  RandomScene humanoid = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/humanoid_hands_and_feet.xml"));
  humanoid.u *= 0.8;
  out.push_back({"humanoid, hands and feet", humanoid, 0.1, 64});
  RandomScene redundant = of_file(load_scene(MANYCONTACT_SOURCE_DIR "/models/feet_on_corners.xml"));
  redundant.u *= 0.5;
  out.push_back({"redundant contacts", redundant, 0.1, 16});
  return out;
}

TEST(Order, IsTheTheorys) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    Simulation truth(c.scene.scene, c.scene.q, c.scene.v, c.scene.u, {Method::kSparseLdl, {}});
    for (int k = 0; k < 16 * c.steps; ++k) truth.step(c.time / (16 * c.steps));
    for (Integrator integrator : kIntegrators) {
      SCOPED_TRACE(to_string(integrator));
      const double order = integrator == Integrator::kRk4 ? 4 : 1;
      const auto error = [&](int steps) {
        return distance(c.scene.scene, simulated(c.scene, integrator, c.time, steps), truth);
      };
      const double coarse = error(c.steps), fine = error(2 * c.steps);
      EXPECT_GT(fine, 1e-12);                           // of the method, not rounding
      EXPECT_LT(coarse, 0.2 * (1 + size_of(truth.v)));  // and resolved
      EXPECT_NEAR(std::log2(coarse / fine), order, 0.25) << coarse << " " << fine;
    }
  }
}

// A body that spins and flies without forces: exp of its velocity, if its inertia is a ball's, in one step.
TEST(Order, UniformMotionIsExact) {
  Model model;
  Joint root;
  root.name = "root";
  root.type = JointType::kFloating;
  root.inertia = Inertia<double>::from_com(2.0, Vec3<double>::Zero(), 0.3 * Mat3<double>::Identity());
  root.lower = root.upper = root.velocity_limit = root.effort_limit = Eigen::VectorXd::Zero(6);
  model.joints = {root};
  model.floating_base = true;
  finalize(model);
  RandomScene s;
  s.scene.gravity.setZero();
  add_robot(s.scene, "ball", std::make_shared<const Model>(model));
  s.q = neutral(model);
  s.v = Vec6<double>(0, 0, 0, 0.3, -2, 0.5);
  s.u.resize(0);
  for (Integrator integrator : kIntegrators) {
    const SimulationData sim = simulated(s, integrator, 1, 1);
    Eigen::VectorXd expected(7);
    integrate<double>(model, s.q, s.v, expected);
    EXPECT_LE(difference_of(sim.q, expected), 1e-15) << to_string(integrator);
    EXPECT_LE(difference_of(sim.v, s.v), 1e-15);
  }
}

}  // namespace
}  // namespace manycontact::test
