#pragma once
// Steps that are too long for a spring. One of stiffness k and damping c, which moves the mass m along it, obeys
// m x'' + c x' + k x = 0; semi-implicit Euler, which takes both at the start of a step, is stable while
//
//     h^2 k / m + 2 h c / m < 4,
//
// RK4 while |h lambda| < 2.6 for lambda^2 + (c/m) lambda + k/m = 0. m is that of the scene with its contacts,
// 1/m = g^T M^-1 g of the torques g of a unit force along the spring. Of each spring alone: several on one body bear
// less.

#include "manycontact/simulation/step.hpp"

namespace manycontact {

struct SpringStep {
  int spring = -1;  // of Scene::springs, or joint_springs; -1: no spring bounds the step
  bool in_joint = false;
  double largest = 0;  // step that it is stable with [s]
};

/// The spring that bears the shortest steps at q (nq), with the contacts flagged `active`.
SpringStep shortest_spring_step(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q,
                                Integrator integrator);

}  // namespace manycontact
