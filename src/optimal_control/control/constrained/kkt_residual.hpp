#pragma once

#include "manycontact/control/kkt_residual.hpp"

namespace manycontact::internal {

/// kkt_residual of nodes that are evaluated. work: memory, of the size that was largest so far. Several parts take more
/// of it each time.
double kkt_residual_of_nodes(const ShootingProblem& problem, const std::vector<Eigen::VectorXd>& xs,
                             const std::vector<Eigen::VectorXd>& us, const std::vector<Eigen::VectorXd>& l, bool limits,
                             const std::vector<Eigen::VectorXd>& ys, double scale, Eigen::VectorXd& work);

/// least_squares_multipliers of nodes that are evaluated.
std::vector<Eigen::VectorXd> least_squares_multipliers_of_nodes(const ShootingProblem& problem,
                                                                const std::vector<Eigen::VectorXd>& us, bool limits);

/// The norm of the gradient of the cost with respect to the controls alone, where the states follow the controls, from
/// nodes that are differentiated at a motion. If limits are used, components that would move a control beyond its limit
/// are left out.
double control_gradient_of_nodes(const ShootingProblem& problem, const std::vector<Eigen::VectorXd>& us, bool limits);

/// The largest fall of the cost within the limits of the controls, to first order: sum_i max over u_i of -g_i du_i,
/// with the gradient g of control_gradient_of_nodes. Infinite if a control without limits matters.
double largest_fall_within_limits(const ShootingProblem& problem, const std::vector<Eigen::VectorXd>& us);

}  // namespace manycontact::internal
