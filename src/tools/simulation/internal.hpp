#pragma once
#include "manycontact/simulation/step.hpp"

namespace manycontact::internal {

/// Computes out = q (+) w for every robot. q and out have nq entries, w has nv.
void integrate_scene(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& w, Eigen::VectorXd& out);

/// Solves data.dynamics at q, v with motor torques u. Returns false if the solve fails.
[[nodiscard]] bool solve_stage(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                               const ConstVector& u, SimulationData& data);

/// Returns whether an active contact may have rows (directions) that rotate. Only then call follow_turning_rows.
bool rows_may_turn(const Scene& scene, const SimulationData& data);
/// For RK4, adds to data.wanted the accelerations that keep J v of 1D and 2D contacts constant although their rows
/// rotate at q, v, and removes the alpha term of these rows. Returns false if no rows rotate.
bool follow_turning_rows(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, SimulationData& data);
/// For semi-implicit Euler, removes the correction of placement errors (gain alpha) from data.wanted for rows that
/// rotate at the start of the step.
void leave_out_alpha_of_turning_rows(const Scene& scene, SimulationData& data);

/// Updates data.condition after a step's first solve, whose result is in `of`, if data.condition_every requests it.
void watch_condition(const Scene& scene, SceneData& of, SimulationData& data);

/// Must follow a step's first solve, whose result is in `of`. In the first step, and after contacts were switched,
/// marks the rows found redundant as redundant for the next steps (dynamics/keep_dependent.hpp).
void keep_what_depends(SceneData& of, SimulationData& data);

/// Computes q+ and v+ from the solution x of semi-implicit Euler, and corrects them with the momentum of free groups.
void end_step(const Scene& scene, const Eigen::VectorXd& x, SimulationData& data);
/// Bound the energy of springs between points (bounded_energy.cpp). Call begin_bound before impulses of springs are
/// added to the momentum of free groups, bound_energy after the step. goes_on: the state is that after the last step.
void begin_bound(const Scene& scene, bool goes_on, SimulationData& data);
void bound_energy(const Scene& scene, SimulationData& data);

/// Computes data.at_rest.kin at q, v, and data.tau = -h times the inverse dynamics for the accelerations data.stop.
void find_momentum(SimulationData& data);

void keep_forces(SimulationData& data);  // copies data.f and data.f_offset from data.dynamics

/// Compute the state after a step in next_q, next_v. Return false if a solve failed.
[[nodiscard]] bool step_semi_implicit_euler(const Scene& scene, const ConstVector& u, SimulationData& data);
[[nodiscard]] bool step_rk4(const Scene& scene, const ConstVector& u, SimulationData& data);

}  // namespace manycontact::internal
