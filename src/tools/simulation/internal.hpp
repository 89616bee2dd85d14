#pragma once
#include "manycontact/simulation/step.hpp"

namespace manycontact::internal {

/// Computes out = q (+) w for every robot. q, out: nq; w: nv.
void integrate_scene(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& w, Eigen::VectorXd& out);

/// Solves data.dynamics at q, v; returns false if that fails.
[[nodiscard]] bool solve_stage(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                               const ConstVector& u, SimulationData& data);

/// Whether an active contact may have rotating rows, which follow_turning_rows must examine.
bool rows_may_turn(const Scene& scene, const SimulationData& data);
/// Adds to data.wanted, for RK4, the accelerations that keep J v of 1D and 2D contacts with rotating rows at q, v,
/// without their alpha. Returns false if no rows rotate.
bool follow_turning_rows(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, SimulationData& data);
/// Removes alpha from semi-implicit Euler's data.wanted for rows that rotate at the start of the step.
void leave_out_alpha_of_turning_rows(const Scene& scene, SimulationData& data);

/// Updates data.condition after a step's first solve, in `of`, if data.condition_every requests it.
void watch_condition(const Scene& scene, SceneData& of, SimulationData& data);

/// After a step's first solve, at the start or after contacts were switched: the rows that are redundant in this solve
/// are treated as redundant from then on (dynamics/keep_dependent.hpp).
void keep_what_depends(SceneData& of, SimulationData& data);

/// Computes q+ and v+ from the result x of semi-implicit Euler's solve, with the momentum of free groups.
void end_step(const Scene& scene, const Eigen::VectorXd& x, SimulationData& data);
/// Bound the energy of springs between points (bounded_energy.cpp): before their impulses are added to free groups'
/// momentum, and after the step's end. goes_on: the state is the last step's end.
void begin_bound(const Scene& scene, bool goes_on, SimulationData& data);
void bound_energy(const Scene& scene, SimulationData& data);

/// Computes data.tau = -h ID(q, v, data.stop), and data.at_rest.kin at q, v.
void find_momentum(SimulationData& data);

/// Sets data.f and f_offset from data.dynamics.
void keep_forces(SimulationData& data);

/// Computes the state after a step in next_q, next_v; returns false if a solve failed.
[[nodiscard]] bool step_semi_implicit_euler(const Scene& scene, const ConstVector& u, SimulationData& data);
[[nodiscard]] bool step_rk4(const Scene& scene, const ConstVector& u, SimulationData& data);

}  // namespace manycontact::internal
