#pragma once

#include "manycontact/control/kkt_residual.hpp"

namespace manycontact::internal {

/// Returns kkt_residual's result from differentiated nodes. work: workspace. Allocates for several subproblems.
double kkt_residual_of_nodes(const ShootingProblem& problem, const std::vector<Eigen::VectorXd>& xs,
                             const std::vector<Eigen::VectorXd>& us, const std::vector<Eigen::VectorXd>& l, bool limits,
                             const std::vector<Eigen::VectorXd>& ys, double scale, Eigen::VectorXd& work);

/// Returns the result of least_squares_multipliers, from differentiated nodes.
std::vector<Eigen::VectorXd> least_squares_multipliers_of_nodes(const ShootingProblem& problem,
                                                                const std::vector<Eigen::VectorXd>& us, bool limits);

/// Returns the norm of the gradient of the cost as a function of the controls alone, with states by simulation. The
/// nodes must be differentiated. limits: leaves out components whose descent would move a control beyond its limit.
double control_gradient_of_nodes(const ShootingProblem& problem, const std::vector<Eigen::VectorXd>& us, bool limits);

/// Returns the largest decrease of the cost within the control limits to first order. It is sum_i max(-g_i du_i) with
/// the gradient g of control_gradient_of_nodes, and infinite if g_i is nonzero for a control without limits.
double largest_fall_within_limits(const ShootingProblem& problem, const std::vector<Eigen::VectorXd>& us);

}  // namespace manycontact::internal
