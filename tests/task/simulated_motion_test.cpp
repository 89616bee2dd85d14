// An optimized motion's torques, in simulation.

#include <gtest/gtest.h>

#include "manycontact/simulation/gains.hpp"
#include "manycontact/simulation/invariants.hpp"
#include "manycontact/simulation/step.hpp"
#include "manycontact/task/forces.hpp"
#include "manycontact/task/optimize.hpp"

namespace manycontact {
namespace {

const std::string kTasks = MANYCONTACT_SOURCE_DIR "/models/tasks/";

TEST(SimulatedMotion, TwoHumanoidsLiftABeam) {
  const TaskFile task = read_task(kTasks + "two_humanoids_lift_beam.xml");
  TaskProblem problem = make_problem(task);
  const TaskSolution s = optimize(task, problem, {TaskSolver::kFddp, 1, {}});
  ASSERT_TRUE(s.converged) << s.reason;
  for (int substeps : {1, 2, 5, 10, 20, 40})
    for (Integrator integrator : {Integrator::kSemiImplicitEuler, Integrator::kRk4})
      for (bool feedback : {false}) {
        Scene scene = task.scene.scene;
        const double h = task.step / substeps;
        const Gains gains = recommended_gains(integrator, h);
        for (Contact& c : scene.contacts) c.alpha = gains.alpha, c.beta = gains.beta;
        SimulationData sim(scene, task.scene.q, task.scene.v, integrator, h);
        InvariantsData room(scene);
        double drift = 0, high = 0, off = 0;
        const int z = scene.robots[2].idx_q + 2;
        for (std::size_t t = 0; t < s.us.size(); ++t) {
          for (int k = 0; k < substeps; ++k) {
            const StepStatus status = step(scene, s.us[t], sim);
            if (status != StepStatus::kOk) {
              std::cout << failure(scene, sim, status) << "\n";
              t = s.us.size();
              break;
            }
            const Invariants at = invariants(scene, sim.dynamics.active, sim.q, sim.v, room);
            drift = std::max(drift, at.position_drift);
            high = std::max(high, sim.q[z]);
          }
          if (t < s.us.size()) off = std::max(off, (sim.q - s.xs[t + 1].head(scene.nq)).lpNorm<Eigen::Infinity>());
        }
        std::cout << to_string(integrator) << " h " << h << " drift " << drift << " beam up to " << high << " end "
                  << sim.q[z] << " off " << off << "\n";
      }
  InvariantsData room(task.scene.scene);
  double drift = 0;
  std::vector<char> active(task.scene.scene.contacts.size(), 1);
  for (const auto& x : s.xs)
    drift = std::max(
        drift, invariants(task.scene.scene, active, x.head(task.scene.scene.nq), x.tail(task.scene.scene.nv), room)
                   .position_drift);
  std::cout << "plan drift " << drift << "\n";
}

}  // namespace
}  // namespace manycontact
