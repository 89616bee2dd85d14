#pragma once

#include "manycontact/control/shooting.hpp"

namespace manycontact::task {

/// Whether the cost falls beside controls at which its gradient vanishes: by rollouts of a few small changes, within
/// the limits where these are kept. Then us are those that did best, xs what they lead to.
bool falls_beside(ShootingProblem& problem, bool limits, double cost, std::vector<Eigen::VectorXd>& xs,
                  std::vector<Eigen::VectorXd>& us);

}  // namespace manycontact::task
