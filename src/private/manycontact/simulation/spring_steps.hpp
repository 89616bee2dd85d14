#pragma once
// Steps that are too long for a spring. One of stiffness k and damping c, which moves the mass m along it, obeys
// m x'' + c x' + k x = 0; semi-implicit Euler that takes both at the start of a step is stable while
//
//     h^2 k / m + 2 h c / m < 4,
//
// RK4 while |h lambda| < 2.6 for lambda^2 + (c/m) lambda + k/m = 0. m is that of the scene with its contacts,
// 1/m = g^T M^-1 g of the torques g of a unit force along the spring. Of each spring alone: several on one body bear
// less.

#include "manycontact/simulation/step.hpp"

namespace manycontact {

struct SpringMobilities {             // 1/m of what springs and dampers move, at one configuration.
  std::vector<Mat3<double>> springs;  // per spring between points: what A's end gains on B's by a unit force on A and
                                      // its opposite on B, in world axes [1/kg]
  Eigen::VectorXd joints;             // nv: of joints' coordinates with a spring or a damper; 0 of others
};
/// At q (nq), with the contacts flagged `active`. Zero where nothing moves, or the solve failed. Joints of a robot with
/// more than a hundred springs and dampers in joints are not asked, for each takes a solve: infinity.
SpringMobilities spring_mobilities(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q);

/// The largest stable step of an integrator that takes k and c, both over m, at the start of a step [s].
double largest_spring_step(Integrator integrator, double k, double c);

struct SpringStep {
  int spring = -1;  // of Scene::springs, or joint_springs; -1: no spring bounds the step
  bool in_joint = false;
  double largest = 0;  // step that it is stable with, taken at the start of a step [s]
};

/// The spring that bears the shortest steps at q (nq), with the contacts flagged `active`.
SpringStep shortest_spring_step(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q,
                                Integrator integrator);

}  // namespace manycontact
