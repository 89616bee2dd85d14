#pragma once
// Many simulations of one scene, stepped at once.
//
//     SimulationBatch batch(scene, Q, V, Integrator::kSemiImplicitEuler, 1e-3);   // a simulation per row
//     step_batch(scene, U, batch);                                                 // batch.q, batch.v: after the step
//
// If the robots of one state do not fill a SIMD batch, several states are stepped together, as one scene with one copy
// per SIMD element. These groups are distributed over threads. Each state moves as `step` alone would move it, up to
// rounding errors. Its numbers do not depend on the other states or on the number of threads.

#include "manycontact/dynamics/batch.hpp"
#include "manycontact/simulation/step.hpp"

namespace manycontact {

/// Simulations of one scene. Numbers in the scene may change, but its structure must not. Only one thread at a time may
/// use a batch.
struct SimulationBatch {
  /// Starts one simulation at each row of q (scene.nq columns) and v (nv columns), with steps of h [s]. threads: 0
  /// takes OpenMP's number. Throws std::invalid_argument for a wrong size or number of threads, or an h that is not
  /// finite and positive.
  SimulationBatch(const Scene& scene, const ConstBatchRows& q, const ConstBatchRows& v, Integrator integrator, double h,
                  int threads = 0, const Options& options = {});

  // These members are set by the caller, between steps, and apply to all states.
  std::vector<char> active;            // one flag per contact; initially as in the scene. A change causes no impact
  std::vector<Vec6<double>> wrenches;  // one per external wrench of the scene; initially the scene's [N, N m]
  double velocity_limit = 1e5;         // m/s, rad/s; a faster state is kTooFast
  Eigen::VectorXd kp, kd;              // gains of PD laws as in PdLaws (nv), or empty
  BatchMatrix q_ref, v_ref;            // references of the PD laws, one row per state (nv columns)

  // These members are set by step_batch, one row or entry per state.
  BatchMatrix q, v;                // the states; set_state changes them
  BatchMatrix f;                   // contact forces at the states before the last step, rows as in Solution::f
  std::vector<StepStatus> status;  // status of the last step that was tried

  struct Part;  // private: states that are stepped together
  struct Work;  // private: all parts, and a workspace per thread
  std::shared_ptr<Work> work;
};

/// Makes `steps` steps of every state with torques u (nu columns, one row per state). A state whose step is not kOk
/// remains as before that step and makes no further steps; other states continue. Throws std::invalid_argument for
/// wrong sizes, before anything is computed.
void step_batch(const Scene& scene, const ConstBatchRows& u, SimulationBatch& batch, int steps = 1);

/// Replaces state k by q (nq), v (nv); other states remain. Throws std::invalid_argument for a wrong size or number.
void set_state(const Scene& scene, Eigen::Index k, const ConstVectorRef& q, const ConstVectorRef& v,
               SimulationBatch& batch);

}  // namespace manycontact
