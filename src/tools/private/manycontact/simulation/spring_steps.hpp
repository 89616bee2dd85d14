#pragma once
// Finds steps h that are too long for a spring, a damper, a PD law or joint friction. With stiffness k, damping c and
// the mass m that a spring moves, the motion is m x'' + c x' + k x = 0. RK4 is stable while |h lambda| < 2.6 for
// lambda^2 + (c/m) lambda + k/m = 0. Semi-implicit Euler, with these forces at the end of a step, is stable for any h.
// With omega^2 = k/m, it keeps a spring's energy if h omega << 1, and dissipates it within few steps if h omega > 2.
// The mass includes the contacts: 1/m = g^T M^-1 g with the torques g of a unit force along the spring. Springs and
// joints are examined one by one; several springs on one body need shorter steps.

#include "manycontact/simulation/step.hpp"

namespace manycontact {

struct SpringMobilities {             // 1/m of bodies on springs and dampers, in one configuration.
  std::vector<Mat3<double>> springs;  // one entry per spring between points: acceleration of the end on A relative to
                                      // B by a unit force on A and its opposite on B, in world axes [1/kg]
  Eigen::VectorXd joints;             // nv: joint coordinates with springs, dampers, PD laws or friction; 0 at others
};
/// Computes mobilities at q (nq) with the contacts flagged `active`. A mobility is zero if nothing moves or the solve
/// failed. Makes one solve per joint. If more than a hundred joints of a robot have forces, their mobility is infinite.
SpringMobilities spring_mobilities(const Scene& scene, const PdLaws& pd, const std::vector<char>& active,
                                   const Eigen::VectorXd& q);

/// Returns the largest step [s] with which RK4 is stable or semi-implicit Euler resolves the oscillation. k and c are
/// stiffness and damping divided by the mass.
double largest_spring_step(Integrator integrator, double k, double c);

struct SpringStep {
  int spring = -1;      // index in Scene::springs; -1: none
  int coordinate = -1;  // index in v of a joint with springs, dampers, a PD law or friction; -1: none
  double largest = 0;   // largest step [s]
  bool any() const { return spring >= 0 || coordinate >= 0; }
};

/// Returns the spring or joint that needs the shortest steps at q (nq) with the contacts flagged `active`.
SpringStep shortest_spring_step(const Scene& scene, const PdLaws& pd, const std::vector<char>& active,
                                const Eigen::VectorXd& q, Integrator integrator);

}  // namespace manycontact
