#pragma once

#include "manycontact/control/shooting.hpp"

namespace manycontact::task {

/// Whether the cost decreases near controls at which its gradient vanishes. Rollouts of a few small changes are
/// compared, within the limits if these are kept. Then `us` are the best controls, and `xs` the states that they cause.
bool falls_beside(ShootingProblem& problem, bool limits, double cost, std::vector<Eigen::VectorXd>& xs,
                  std::vector<Eigen::VectorXd>& us);

}  // namespace manycontact::task
