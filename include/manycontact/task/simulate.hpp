#pragma once
// Simulates an optimized motion, with the solver's torques and feedback, and steps smaller than the task's.

#include "manycontact/simulation/switch.hpp"
#include "manycontact/task/optimize.hpp"

namespace manycontact {

/// The simulated motion, and its distance from the solution and the contacts.
struct SimulatedMotion {
  StepStatus stopped = StepStatus::kOk;  // kOk, or why the simulation ended early
  std::vector<Eigen::VectorXd> xs;       // states at the nodes; when contacts close, the state before the impact
  double energy_lost = 0;                // loss in impacts, J
  double violation_position = 0;         // largest placement error of the active contacts, after any step [m, rad]
  double violation_velocity = 0;         // [m/s, rad/s]
  double distance = 0;                   // largest component of x (-) xs at any node, where xs is the solution
};

/// Simulates the controls u = us_t - K_t (x (-) xs_t), which are constant between nodes, with the phases' contacts.
/// substeps: number of steps per node.
///
/// A contact that closes at a change of phase stops the frames' relative velocity (switch_contacts), even if the phase
/// has no impact. The contact then constrains the frames at their current placements, or with at="scene" at the
/// placement in the scene. The contacts' gains are those that the integrator recommends for the size of a substep; the
/// scene's gains are meant for the task's step. Without K in the solution, u = us_t.
///
/// Throws std::invalid_argument for less than one step per node, and for a solution of another task. Allocates.
SimulatedMotion simulate(const TaskFile& task, const TaskSolution& solution, Integrator integrator, int substeps);

}  // namespace manycontact
