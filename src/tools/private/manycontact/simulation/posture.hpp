#pragma once
// Singular configurations that a motion passes, between its states too. With w a unit vector of contact rows, x = M^-1
// J^T w and sigma^2 = w^T J M^-1 J^T w, the smallest sigma measures how near an island's contacts are to losing rank.
// It is followed by one inverse iteration per state, which a solve of the island at rest does,
//
//     [ M  J^T ] [  a ]   [ 0 ]
//     [ J   0  ] [ -f ] = [ w ]      w+ = f / |f|,   x = a / |f|,   sigma^2 = w^T w+ / |f|
//
// Where the motion passes a singular configuration x goes through zero and comes out on its other side; where it passes
// close by, past it. Between two states x is taken for straight, so that the least sigma of a step is
//
//     min over s in [0, 1] of | (1 - s) x_k + s x_k+1 |_M
//
// A state that is singular itself shows as a lost rank, not here. Inverse iteration: Golub, Van Loan, Matrix
// Computations, section 8.2.

#include "manycontact/simulation/step.hpp"

namespace manycontact {

struct ClosestPosture {  // The configuration between two states that is nearest to a singular one.
  double share = 1;      // least sigma between the last state and this one, of the largest sigma so far
  double at = 0;         // position between the states: 0: at the last state; 1: at this one
};

struct PostureData {  // The islands' smallest sigma, and the memory of its solves.
  /// Makes the memory for this scene. options: used in the solves.
  explicit PostureData(const Scene& scene, const Options& options = {});

  SceneAtRest rest;
  SceneData dynamics;
  std::vector<char> active;  // contacts active at the last state
  bool known = false;        // w, x, sigma are those of the last state
  Eigen::VectorXd w, x;      // rows of f; nv
  Eigen::VectorXd asked, Jx, scratch;
  std::vector<double> sigma, largest;  // one entry per island: sigma at the last state; its largest value so far
};

/// Continues to the state q (nq), with the contacts flagged `active`. Returns the closest configuration of all islands.
/// The first state, and a state with other contacts than the last one, start again.
ClosestPosture follow_posture(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q,
                              PostureData& data);

}  // namespace manycontact
