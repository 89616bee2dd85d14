#include "manycontact/task/simulate.hpp"

#include <algorithm>

#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/detail/control/parts.hpp"
#include "manycontact/detail/simulation/invariants.hpp"
#include "manycontact/simulation/gains.hpp"
#include "nodes.hpp"

namespace manycontact {

namespace {

// Returns the torques us[t] - K[t] dx of node t with the solution's gains K, where dx = x (-) xs[t].
Eigen::VectorXd torques(const TaskSolution& solution, std::size_t t, const Eigen::VectorXd& dx) {
  Eigen::VectorXd u = solution.us[t];
  for (const TaskGains& part : solution.gains) {
    if (part.K[t].rows() == 0) continue;
    Eigen::VectorXd own;
    gather(dx, part.dx, own);
    const Eigen::VectorXd du = part.K[t] * own;
    for (std::size_t i = 0; i < part.u.size(); ++i) u[part.u[i]] -= du[i];
  }
  return u;
}

void check_fits(const TaskFile& task, const TaskSolution& solution, const StateMultibody& state) {
  const std::size_t T = static_cast<std::size_t>(task.nodes());
  bool fits = solution.xs.size() == T + 1 && solution.us.size() == T;
  for (const TaskGains& part : solution.gains) fits = fits && part.K.size() == T;
  for (const Eigen::VectorXd& x : solution.xs) fits = fits && x.size() == static_cast<Eigen::Index>(state.get_nx());
  require(fits, "simulate", "the solution belongs to another task, a solution of this task is expected");
}

// Activates the contacts of the phase. Closing contacts constrain their frames to the current placements, or, if the
// phase has at="scene", to the placements of the scene. Returns false if the impact failed.
bool switch_to(const TaskPhase& phase, Scene& scene, SimulationData& world, SimulatedMotion& out) {
  const std::vector<char> active(phase.active.begin(), phase.active.end());
  for (std::size_t c = 0; c < active.size(); ++c)
    if (active[c] && !world.dynamics.active[c] && !phase.at_scene)
      resolve_reference(scene, world.q, true, true, scene.contacts[c]);
  const VelocityJump jump = switch_contacts(scene, active, world);
  out.energy_lost += jump.energy_lost;
  return jump.status != Status::kFailed;
}

// Returns the scene with the contacts of the first phase, with the integrator's recommended gains for steps of h.
Scene held(const TaskFile& task, Integrator integrator, double h) {
  Scene scene = task::scene_with(task, task.phases.front().active);
  const Gains gains = recommended_gains(integrator, h);
  for (Contact& contact : scene.contacts) {
    contact.alpha = gains.alpha;
    contact.beta = gains.beta;
  }
  return scene;
}

}  // namespace

SimulatedMotion simulate(const TaskFile& task, const TaskSolution& solution, Integrator integrator, int substeps) {
  require(substeps >= 1, "simulate", "substeps is below 1, at least one step for each node is expected");
  const StateMultibody state(task.scene.scene);
  check_fits(task, solution, state);
  const double h = task.step / substeps;
  Scene scene = held(task, integrator, h);
  SimulationData world(scene, task.scene.q, task.scene.v, integrator, h);
  InvariantsData room(scene);
  Eigen::VectorXd x(scene.nq + scene.nv), dx(2 * scene.nv);
  SimulatedMotion out;
  const std::vector<TaskNode> nodes = timeline(task);
  for (std::size_t t = 0;; ++t) {
    x << world.q, world.v;
    state.diff(solution.xs[t], x, dx);
    out.xs.push_back(x);
    out.distance = std::max(out.distance, dx.lpNorm<Eigen::Infinity>());
    if (t + 1 == nodes.size()) return out;
    if (!switch_to(phase_at(task, nodes[t]), scene, world, out)) {
      out.stopped = StepStatus::kSolverFailed;
      return out;
    }
    if (nodes[t].impact) continue;
    if (const TaskPhase& phase = phase_at(task, nodes[t]); !phase.wrenches.empty())
      world.dynamics.wrenches = phase.wrenches;
    x << world.q, world.v;
    state.diff(solution.xs[t], x, dx);
    const Eigen::VectorXd u = torques(solution, t, dx);
    for (int k = 0; k < substeps; ++k) {
      out.stopped = step(scene, u, world);
      if (out.stopped != StepStatus::kOk) return out;
      const Invariants at = invariants(scene, world.dynamics.active, world.q, world.v, room);
      out.violation_position = std::max(out.violation_position, at.violation_position);
      out.violation_velocity = std::max(out.violation_velocity, at.violation_velocity);
    }
  }
}

}  // namespace manycontact
