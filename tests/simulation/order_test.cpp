// The integrators' order is measured against a fine run of classical RK4 with quaternions' own derivative.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "simulation/scenes.hpp"

namespace manycontact::test {
namespace {

// Returns the larger of |q - q'| on the manifold and |v - v'|.
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
  int steps;  // of the coarser run
};

std::vector<Case> cases() {
  std::vector<Case> out;
  for (int seed : {1, 2, 3})
    out.push_back({"free " + std::to_string(seed), free_scene(seed), 0.2, seed == 3 ? 128 : 64});
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
      EXPECT_GT(fine, 1e-12);                           // the method's error, not rounding
      EXPECT_LT(coarse, 0.2 * (1 + size_of(truth.v)));  // and the motion is resolved
      EXPECT_NEAR(std::log2(coarse / fine), order, 0.25) << coarse << " " << fine;
    }
  }
}

// Returns one floating body without gravity.
RandomScene one_body(const Inertia<double>& inertia) {
  Model model;
  Joint root;
  root.name = "root";
  root.type = JointType::kFloating;
  root.inertia = inertia;
  root.lower = root.upper = root.velocity_limit = root.effort_limit = Eigen::VectorXd::Zero(6);
  model.joints = {root};
  model.floating_base = true;
  finalize(model);
  RandomScene s;
  s.scene.gravity.setZero();
  add_robot(s.scene, "ball", std::make_shared<const Model>(model));
  s.q = neutral(model);
  s.u.resize(0);
  return s;
}

// ---- invariants of a free body, by four integrators: errors against h, next to theory (mathematics.md has the table)

struct Method4 {
  const char* name;
  double energy_order, momentum_order;  // 0: exact up to rounding
  std::function<void(const RandomScene&, double, int, Eigen::VectorXd&, Eigen::VectorXd&)> run;
};

void accelerate(const RandomScene& s, const Eigen::VectorXd& q, const Eigen::VectorXd& v, SceneData& data) {
  ASSERT_EQ(solve(s.scene, q, v, s.u, data).status, Status::kOk);
}

// Tasks' Euler is Crocoddyl's: v+ = v + h a, q+ = q (+) h v+.
void tasks_euler(const RandomScene& s, double h, int steps, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  SceneData data(s.scene, {Method::kSparseLdl, {}});
  for (int k = 0; k < steps; ++k) {
    accelerate(s, q, v, data);
    v += h * data.a;
    const Eigen::VectorXd from = q;
    integrate<double>(*s.scene.robots[0].model, from, h * v, q);
  }
}

// The midpoint rule is that of tasks' rk2.
void midpoint(const RandomScene& s, double h, int steps, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  SceneData data(s.scene, {Method::kSparseLdl, {}});
  for (int k = 0; k < steps; ++k) {
    accelerate(s, q, v, data);
    const Eigen::VectorXd from = q, middle_v = v + h / 2 * data.a;
    integrate<double>(*s.scene.robots[0].model, from, h / 2 * v, q);
    accelerate(s, q, middle_v, data);
    v += h * data.a;
    integrate<double>(*s.scene.robots[0].model, from, h * middle_v, q);
  }
}

auto by_step(Integrator integrator) {
  return [integrator](const RandomScene& s, double h, int steps, Eigen::VectorXd& q, Eigen::VectorXd& v) {
    const SimulationData sim = simulated(s, integrator, h * steps, steps);
    q = sim.q, v = sim.v;
  };
}

TEST(Order, EnergyAndMomentumOfATumblingBody) {
  const Method4 methods[] = {{"tasks' euler", 1, 1, tasks_euler},
                             {"tasks' rk2", 2, 2, midpoint},
                             {"semi-implicit-euler", 1, 0, by_step(Integrator::kSemiImplicitEuler)},
                             {"rk4", 4, 4, by_step(Integrator::kRk4)}};
  RandomScene s = one_body(Inertia<double>::from_com(2, {0.1, 0, 0.05}, Vec3<double>(0.2, 0.3, 0.45).asDiagonal()));
  s.v = Vec6<double>(1, 0.5, -0.3, 3, 4, 5);
  const Invariants start = start_of(s);
  std::printf("errors after 1 s of tumbling at 7 rad/s, relative\n%-20s %8s %10s %10s %10s\n", "integrator", "h [s]",
              "energy", "linear", "angular");
  for (const Method4& m : methods) {
    double last[3] = {0, 0, 0};
    for (int steps : {250, 500, 1000, 2000}) {
      Eigen::VectorXd q = s.q, v = s.v;
      m.run(s, 1.0 / steps, steps, q, v);
      const Invariants end = invariants_of(s, q, v);
      const Vec6<double> dh = end.momentum - start.momentum;
      const double error[3] = {std::abs(end.energy() - start.energy()) / start.kinetic,
                               dh.head<3>().norm() / start.momentum.head<3>().norm(),
                               dh.tail<3>().norm() / start.momentum.tail<3>().norm()};
      std::printf("%-20s %8g %10.1e %10.1e %10.1e\n", m.name, 1.0 / steps, error[0], error[1], error[2]);
      for (int i = 0; i < 3; ++i) {
        const double order = i == 0 ? m.energy_order : m.momentum_order;
        if (order == 0) {
          EXPECT_LE(error[i], 1e-12) << m.name;
        }
        if (order > 0 && steps == 2000 && error[i] > 1e-11) {
          EXPECT_GE(std::log2(last[i] / error[i]), order - 0.2) << m.name << " " << i;
        }
        last[i] = error[i];
      }
    }
    std::printf("%-20s %8s %10g %10g %10g\n", "  order, in theory", "", m.energy_order, m.momentum_order,
                m.momentum_order);
  }
}

// M changes as joints move, and semi-implicit Euler evaluates Coriolis forces at the start of a step: a free motion may
// gain energy, at a rate that decreases with the step.
TEST(Order, EnergyOfWhatMovesFreely) {
  for (int seed : {1, 2, 3, 4, 5, 6}) {
    RandomScene s = free_scene(seed, false);
    s.scene.gravity.setZero();
    s.u.setZero();
    const double before = start_of(s).kinetic;
    double last = 0;
    for (int steps : {100, 200, 400, 800}) {
      const double error = end_of(s, simulated(s, Integrator::kSemiImplicitEuler, 0.1, steps)).kinetic - before;
      if (steps == 800) {
        EXPECT_NEAR(last / error, 2, 0.2) << seed;
      }
      last = error;
    }
  }
}

// A body spins and flies without forces. If its inertia is a ball's, one step is exp of its velocity.
TEST(Order, UniformMotionIsExact) {
  RandomScene s = one_body(Inertia<double>::from_com(2.0, Vec3<double>::Zero(), 0.3 * Mat3<double>::Identity()));
  s.v = Vec6<double>(0, 0, 0, 0.3, -2, 0.5);
  for (Integrator integrator : kIntegrators) {
    const SimulationData sim = simulated(s, integrator, 1, 1);
    Eigen::VectorXd expected(7);
    integrate<double>(*s.scene.robots[0].model, s.q, s.v, expected);
    EXPECT_LE(difference_of(sim.q, expected), 1e-15) << to_string(integrator);
    EXPECT_LE(difference_of(sim.v, s.v), 1e-15);
  }
}

}  // namespace
}  // namespace manycontact::test
