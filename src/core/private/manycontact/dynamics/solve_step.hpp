#pragma once
// The equations of a semi-implicit Euler step, evaluated and solved in SIMD batches.

#include "manycontact/dynamics/solve.hpp"

namespace manycontact {

/// The start of a step of h [s], for a scene at rest (simulation/step.hpp).
struct StartOfStep {
  const double *v, *stop;  // scene.nv: velocities, and the acceleration that stops them within the step
  Vec3<double> gravity;    // gravity, which the scene at rest does not have
  double h;
  double* contact_v;  // output, rows as Solution::f: J a, velocities of the contact rows after the step
};

/// Solves, at the configuration q of a scene without gravity, external wrenches, springs and joint friction,
///
///     [ M  J^T     ] [  a ]   [ tau - h ID(q, v, stop)   ]
///     [ J  -delta I] [ -f ] = [     prescribed - a0      ]        ID without armature
///
/// where a is the velocity after the step. True: the solution is in data, as after solve_tau with prescribed
/// accelerations. False: some island is no single robot in a SIMD batch of doubles, or had no sound solution there.
[[nodiscard]] bool solve_step(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& tau,
                              const ConstVectorRef& prescribed, const StartOfStep& start, SceneData& data);

}  // namespace manycontact
