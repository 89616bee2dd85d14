#pragma once
// The equations of a semi-implicit Euler step, with all that depends on the state computed in SIMD batches.

#include "manycontact/dynamics/solve.hpp"

namespace manycontact {

/// The start of a step of h [s], for a scene at rest (simulation/step.hpp).
struct StartOfStep {
  const double *v, *stop;  // scene.nv: the velocities, and the acceleration that ends them within the step
  Vec3<double> gravity;  // gravity, which the scene at rest lacks
  double h;
  double* contact_v;  // out, rows as Solution::f: J a, the velocities of the contacts' rows after the step
};

/// Solves, at the configuration q of a scene without gravity, external wrenches, springs and joint friction,
///
///     [ M  J^T     ] [  a ]   [ tau - h ID(q, v, stop)   ]
///     [ J  -delta I] [ -f ] = [     prescribed - a0      ]        ID without armature
///
/// where a is the velocity after the step. True: the solution is in data, like that of solve_tau with prescribed
/// accelerations. False: there is none, because not all robots are alone in SIMD batches of doubles, or because one
/// has to be solved in another way.
[[nodiscard]] bool solve_step(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& tau,
                              const ConstVectorRef& prescribed, const StartOfStep& start, SceneData& data);

}  // namespace manycontact
