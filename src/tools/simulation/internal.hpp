#pragma once
#include "manycontact/simulation/step.hpp"

namespace manycontact::internal {

/// out = q (+) w for every robot. q, out: nq; w: nv.
void integrate_scene(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& w, Eigen::VectorXd& out);

/// data.dynamics at q, v; false when it failed.
[[nodiscard]] bool solve_stage(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                               const ConstVector& u, SimulationData& data);

/// Whether an active contact has rows that may rotate, which follow_turning_rows must examine.
bool rows_may_turn(const Scene& scene, const SimulationData& data);
/// Adds to data.wanted what keeps J v of 1D and 2D contacts whose rows turn at q, v, without their alpha, for RK4.
/// False: no rows turn.
bool follow_turning_rows(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, SimulationData& data);
/// Takes alpha out of semi-implicit Euler's data.wanted where rows turn at the start of the step.
void leave_out_alpha_of_turning_rows(const Scene& scene, SimulationData& data);

/// Call it after a step's first solve, in `of`. Updates data.condition where data.condition_every requests it.
void watch_condition(const Scene& scene, SceneData& of, SimulationData& data);

/// Call it after a step's first solve. At the start, and after contacts were switched, the rows that are redundant in
/// this solve are treated as redundant from then on (dynamics/keep_dependent.hpp).
void keep_what_depends(SceneData& of, SimulationData& data);

/// q+ and v+ from x, the result of semi-implicit Euler's solve, with the momentum of free groups.
void end_step(const Scene& scene, const Eigen::VectorXd& x, SimulationData& data);
/// Bounds what springs between points give (bounded_energy.cpp): before their impulses are added to the momentum of
/// free groups, and after the step's end. goes_on: the state is that of the last step's end.
void begin_bound(const Scene& scene, bool goes_on, SimulationData& data);
void bound_energy(const Scene& scene, SimulationData& data);

/// data.tau = -h ID(q, v, data.stop), with data.at_rest.kin at q, v.
void find_momentum(SimulationData& data);

/// Sets data.f and f_offset from data.dynamics.
void keep_forces(SimulationData& data);

/// The state after a step into next_q, next_v; false when a solve failed.
[[nodiscard]] bool step_semi_implicit_euler(const Scene& scene, const ConstVector& u, SimulationData& data);
[[nodiscard]] bool step_rk4(const Scene& scene, const ConstVector& u, SimulationData& data);

}  // namespace manycontact::internal
