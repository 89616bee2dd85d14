#pragma once

#include "manycontact/control/kkt_residual.hpp"

namespace manycontact::internal {

/// Computes kkt_residual from evaluated nodes. work: grows if needed; several subproblems allocate more at each call.
double kkt_residual_of_nodes(const ShootingProblem& problem, const std::vector<Eigen::VectorXd>& xs,
                             const std::vector<Eigen::VectorXd>& us, const std::vector<Eigen::VectorXd>& l, bool limits,
                             const std::vector<Eigen::VectorXd>& ys, double scale, Eigen::VectorXd& work);

/// Computes least_squares_multipliers from evaluated nodes.
std::vector<Eigen::VectorXd> least_squares_multipliers_of_nodes(const ShootingProblem& problem,
                                                                const std::vector<Eigen::VectorXd>& us, bool limits);

/// Computes the norm of the cost's gradient with respect to the controls alone, with states that follow the controls,
/// from differentiated nodes. With limits, components that would move a control beyond its limit are left out.
double control_gradient_of_nodes(const ShootingProblem& problem, const std::vector<Eigen::VectorXd>& us, bool limits);

/// Computes the largest decrease of the cost within the controls' limits, to first order: sum_i max over u_i of -g_i
/// du_i, with the gradient g of control_gradient_of_nodes. Infinite if a control without limits has a nonzero g_i.
double largest_fall_within_limits(const ShootingProblem& problem, const std::vector<Eigen::VectorXd>& us);

}  // namespace manycontact::internal
