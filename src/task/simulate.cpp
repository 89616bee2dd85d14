#include "manycontact/task/simulate.hpp"

#include <algorithm>

#include "manycontact/control/parts.hpp"
#include "manycontact/simulation/gains.hpp"
#include "manycontact/simulation/invariants.hpp"

namespace manycontact {

namespace {

// us - K (x (-) xs) of node t; dx: x (-) xs
Eigen::VectorXd torques(const TaskSolution& solution, std::size_t t, const Eigen::VectorXd& dx) {
  Eigen::VectorXd u = solution.us[t];
  for (const TaskGains& part : solution.gains) {
    Eigen::VectorXd own;
    gather(dx, part.dx, own);
    const Eigen::VectorXd du = part.K[t] * own;
    for (std::size_t i = 0; i < part.u.size(); ++i) u[part.u[i]] -= du[static_cast<Eigen::Index>(i)];
  }
  return u;
}

}  // namespace

SimulatedMotion simulate(const TaskFile& task, const TaskProblem& problem, const TaskSolution& solution,
                         Integrator integrator, int substeps) {
  require(substeps >= 1, "simulate", "a step to a node at least is expected");
  Scene scene = task.scene.scene;
  const double h = task.step / substeps;
  const Gains gains = recommended_gains(integrator, h);
  for (Contact& contact : scene.contacts) {
    contact.alpha = gains.alpha;
    contact.beta = gains.beta;
  }
  SimulationData world(scene, task.scene.q, task.scene.v, integrator, h);
  InvariantsData room(scene);
  const std::vector<int> phases = phase_of_node(task);
  Eigen::VectorXd x(scene.nq + scene.nv), dx(2 * scene.nv);
  SimulatedMotion out;
  for (std::size_t t = 0;; ++t) {
    x << world.q, world.v;
    problem.state->diff(solution.xs[t], x, dx);
    out.xs.push_back(x);
    out.distance = std::max(out.distance, dx.lpNorm<Eigen::Infinity>());
    if (t == phases.size()) return out;
    const std::vector<bool>& active = task.phases[static_cast<std::size_t>(phases[t])].active;
    std::copy(active.begin(), active.end(), world.dynamics.active.begin());
    const Eigen::VectorXd u = torques(solution, t, dx);
    for (int k = 0; k < substeps; ++k) {
      out.stopped = step(scene, u, world);
      if (out.stopped != StepStatus::kOk) return out;
      const Invariants at = invariants(scene, world.dynamics.active, world.q, world.v, room);
      out.position_drift = std::max(out.position_drift, at.position_drift);
      out.velocity_drift = std::max(out.velocity_drift, at.velocity_drift);
    }
  }
}

}  // namespace manycontact
