#pragma once
// The equations of a semi-implicit Euler step of a simulation, evaluated and solved in SIMD batches.

#include "manycontact/dynamics/solve.hpp"

namespace manycontact {

/// The state at the start of a step (simulation/step.hpp). The step is solved on a scene at rest, without velocities
/// and gravity.
struct StartOfStep {
  const double *v, *stop;  // scene.nv: velocities, and the accelerations that stop them within the step
  Vec3<double> gravity;    // gravity of the simulated scene [m/s^2]
  double h;                // length of the step [s]
  double* contact_v;  // output: velocities J a of the contact rows after the step, in the order of SceneData::f
};

/// Solves, at the configuration q of a scene without gravity, external wrenches, springs and joint friction,
///
///     [ M  J^T     ] [  a ]   [ tau - h ID(q, v, stop)   ]
///     [ J  -delta I] [ -f ] = [     prescribed - a0      ]        ID without armature
///
/// where a is the velocity after the step. Returns true if the solution is in data, as after solve_tau with prescribed
/// accelerations. Returns false if not every island is a single robot that SIMD batches in double precision can solve.
[[nodiscard]] bool solve_step(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& tau,
                              const ConstVectorRef& prescribed, const StartOfStep& start, SceneData& data);

}  // namespace manycontact
