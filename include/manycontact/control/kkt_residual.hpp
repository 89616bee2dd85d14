#pragma once

#include "manycontact/control/shooting.hpp"

namespace manycontact {

/// Computes the largest violation of the optimality conditions at states x_t and controls u_t. The multipliers of the
/// dynamics are l_0 ... l_T. Those of the constraints c = [g; h], lo <= c <= hi (0 for h), are y_0 ... y_T. P projects
/// onto [lo, hi].
///
///     gaps               x0 (-) x_0,  f_t(x_t, u_t) (-) x_(t+1)
///     stationarity in x  lx_t + fx_t^T l_(t+1) + cx_t^T y_t - l_t,  lx_T + cx_T^T y_T - l_T
///     stationarity in u  lu_t + fu_t^T l_(t+1) + cu_t^T y_t
///     constraints        c - P(c + y):  bounds, signs of y (>= 0 at an upper bound) and complementarity
///
/// With `limits`, stationarity s in u is replaced by u - min(max(u - s, u_lb), u_ub). Without constraint_multipliers,
/// constraints are left out. The nodes are evaluated, with derivatives, at xs, us. The result is infinite if a number
/// is not finite. `scale` is the unit of the cost: gradients and multipliers are divided by it. Throws
/// std::invalid_argument for wrong sizes, and a scale that is not above 0.
double kkt_residual(ShootingProblem& problem, const std::vector<Eigen::VectorXd>& xs,
                    const std::vector<Eigen::VectorXd>& us, const std::vector<Eigen::VectorXd>& multipliers,
                    bool limits, const std::vector<Eigen::VectorXd>& constraint_multipliers = {}, double scale = 1);

/// Computes the multipliers l of the dynamics that minimise |r|^2, where r are the residuals of stationarity in x and u
/// (Nocedal & Wright, Numerical Optimization, 18.3). They are the multipliers of the linear-quadratic problem
///
///     minimise  sum_t lx_t^T dx_t + lu_t^T du_t + 1/2 |dx_t|^2 + 1/2 |du_t|^2    with  dx_0 = 0,
///     dx_(t+1) = fx_t dx_t + fu_t du_t,
///
/// whose solution is -r, the gradient projected onto the motions that the linearised dynamics allow. With `limits`,
/// controls at a limit are left out. Other multipliers, such as gradients of a solver's value function, give larger
/// residuals than these. The nodes are evaluated, with derivatives, at xs, us.
std::vector<Eigen::VectorXd> least_squares_multipliers(ShootingProblem& problem, const std::vector<Eigen::VectorXd>& xs,
                                                       const std::vector<Eigen::VectorXd>& us, bool limits);

}  // namespace manycontact
