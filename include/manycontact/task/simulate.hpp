#pragma once
// Simulates an optimized motion, with the solver's torques and feedback, and steps smaller than the task's.

#include "manycontact/simulation/switch.hpp"
#include "manycontact/task/optimize.hpp"

namespace manycontact {

/// The simulated motion, and its distance from the solution and the contacts.
struct SimulatedMotion {
  StepStatus stopped = StepStatus::kOk;  // kOk, or why the simulation ended early
  std::vector<Eigen::VectorXd> xs;       // states at the nodes; where contacts close, before their impact
  double energy_lost = 0;                // loss in impacts, J
  double violation_position = 0;         // largest placement error of the active contacts, after any step [m, rad]
  double violation_velocity = 0;         // [m/s, rad/s]
  double distance = 0;                   // largest component of x (-) xs at any node, where xs is the solution
};

/// Simulates u = us_t - K_t (x (-) xs_t), constant between nodes, with the phases' contacts; substeps: >= 1, per node.
///
/// A contact that closes at a change of phase stops its frames at once (switch_contacts), whether the phase has an
/// impact or not. It constrains them where they are then, unless the phase requires the placement in the scene
/// (at="scene"). The contacts have the integrator's recommended gains for these steps; those of the scene are meant for
/// the task's step. A solution without gains is followed by its torques alone.
///
/// Throws std::invalid_argument for less than one step, and for a solution of another task. Allocates.
SimulatedMotion simulate(const TaskFile& task, const TaskSolution& solution, Integrator integrator, int substeps);

}  // namespace manycontact
