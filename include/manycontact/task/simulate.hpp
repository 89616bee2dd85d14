#pragma once
// An optimized motion in simulation: the solver's torques and feedback, on steps finer than the task's.

#include "manycontact/simulation/switch.hpp"
#include "manycontact/task/optimize.hpp"

namespace manycontact {

/// Where the simulation went, and how far from the solution and off its contacts.
struct SimulatedMotion {
  StepStatus stopped = StepStatus::kOk;  // anything else: the simulation ended there
  std::vector<Eigen::VectorXd> xs;       // at the nodes; where contacts close, before their impact
  double energy_lost = 0;                // by impacts, J
  double position_drift = 0;             // largest of the active contacts, after any step [m, rad]
  double velocity_drift = 0;             // [m/s, rad/s]
  double distance = 0;                   // largest component of x (-) xs, the solution's, at any node
};

/// With u = us_t - K_t (x (-) xs_t), held from node t to the next, and in each phase its contacts; `substeps` steps (1
/// at least) to a node. A contact that closes at a change of phase stops its frames at once (switch_contacts), whether
/// the phase has an impact or not, and holds them where they are then: a foot does not slide to where the scene has its
/// contact, unless the phase asks for that (at="scene"). Contacts have the integrator's recommended gains for such
/// steps, not the scene's, which are for the task's step. A solution without gains is followed by its torques alone.
/// Throws std::invalid_argument for less than a step, and for a solution of another task.
SimulatedMotion simulate(const TaskFile& task, const TaskSolution& solution, Integrator integrator, int substeps);

}  // namespace manycontact
