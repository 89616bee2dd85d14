#pragma once
// Springs and dampers that semi-implicit Euler's steps are too long for, taken at the end of the step. With g the
// torques of a unit force along a spring, g^T v its rate, and s its length at the start,
//
//     force = -k (s - length + h g^T v+) - c g^T v+        so that M becomes M + sum of g (h^2 k + h c) g^T,
//
// and on the right-hand side g h c g^T v makes good what the damper at the start took. A joint's spring adds to M's
// diagonal, as a rotor's inertia does: the scene at rest is solved with other armatures. Those between points add
// U D U^T of low rank. With K the rest of the matrix and x0 what it gives without them, their impulses y on U are
//
//     (D^-1 + U^T K^-1 U) y = U^T x0,        and then K x = b - U y
//
// (Woodbury). K^-1 U takes a solve for each spring of an island, those of all islands together. Across a spring that
// pulls by f at the distance s, f / s is a stiffness too, and taken so where the step needs it.
//
// A mode with h^2 k / m = a loses 1 - 1 / (1 + a) of its energy's root in a step at least: what a step cannot follow
// dies out. Springs for which h is below half of what they bear stay where they are, at the start of the step, which
// keeps energy over long times.

#include <Eigen/Cholesky>

#include "manycontact/simulation/spring_steps.hpp"
#include "unit_forces.hpp"

namespace manycontact {

struct ImplicitSprings {
  explicit ImplicitSprings(const Scene& scene) : unit(scene) {}

  // When first stepped, without contacts: about the most that springs can move.
  bool measured = false;
  Eigen::VectorXd of_joints;       // nv: SpringMobilities::joints
  std::vector<double> of_springs;  // per spring: the largest over directions
  // Those of joints. Where there are none, SimulationData::at_rest and dynamics serve.
  Eigen::VectorXd added, to_add, stiffness;  // nv: to the diagonal, as solved with; in this step; k of coordinates
  std::unique_ptr<SceneAtRest> at_rest;      // with `added` in its armatures
  std::unique_ptr<SceneData> dynamics;       // of that
  // Those between points.
  internal::UnitTorques unit;
  std::vector<internal::UnitForce> forces;  // U
  std::vector<double> D, c;                 // of each: h^2 k + h c; c
  std::vector<int> of_island;               // per robot: the force of its island that is asked for, -1
  Eigen::MatrixXd C;                        // D^-1 + U^T K^-1 U
  Eigen::LDLT<Eigen::MatrixXd> factor;
  Eigen::VectorXd b, y, none;
};

}  // namespace manycontact
