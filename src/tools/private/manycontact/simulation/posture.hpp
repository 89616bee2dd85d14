#pragma once
// Detects singular configurations that a motion passes, also between its states. With w a unit vector of contact rows,
// x = M^-1 J^T w and sigma^2 = w^T J M^-1 J^T w, the smallest sigma measures how close an island's contacts are to
// losing rank. One inverse iteration per state updates the w of this sigma, by a solve of the island at rest:
//
//     [ M  J^T ] [  a ]   [ 0 ]
//     [ J   0  ] [ -f ] = [ w ]      w+ = f / |f|,   x = a / |f|,   sigma^2 = w^T w+ / |f|
//
// If the motion passes through a singular configuration, x passes through zero; if it passes close by, x passes near
// zero. Between two states x is interpolated linearly, so that the least sigma of a step is
//
//     min over s in [0, 1] of | (1 - s) x_k + s x_k+1 |_M
//
// A state that is itself singular is detected by its rank. Source: Golub, Van Loan, Matrix Computations, sec. 8.2.

#include "manycontact/simulation/step.hpp"

namespace manycontact {

struct ClosestPosture {  // The configuration between two states that is nearest to a singular one.
  double share = 1;      // least sigma between the last and the current state, relative to the largest sigma so far
  double at = 0;         // position of the least sigma: 0 at the last state, 1 at the current state
};

struct PostureData {  // Smallest sigma of each island, and workspace for its solves.
  explicit PostureData(const Scene& scene, const Options& options = {});  // options: those of the solves

  SceneAtRest rest;
  SceneData dynamics;
  std::vector<char> active;  // flags of the contacts that were active at the last state
  bool known = false;        // whether w, x, sigma belong to the last state
  Eigen::VectorXd w, x;      // rows of f; nv
  Eigen::VectorXd asked, Jx, scratch;
  std::vector<double> sigma, largest;  // one entry per island: sigma at the last state; its maximum so far
};

/// Proceeds to the state q (nq) with the contacts flagged `active`. Returns the closest configuration of the island
/// that has the least share. The first call, and a change of `active`, restart the inverse iteration.
ClosestPosture follow_posture(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q,
                              PostureData& data);

}  // namespace manycontact
