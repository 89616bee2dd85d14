#pragma once
// The optimality conditions H z + h = 0 of lq/problem.hpp and their error. H is symmetric; z = (x, u, w, lambda, mu).

#include "manycontact/lq/problem.hpp"

namespace manycontact::lq {

/// Sets h from the problem: h.x to q, h.u and h.w to r, h.lambda to x0, then f of the knots 0 ... T-1, and h.mu to d.
void linear_terms(const Problem& problem, const Layout& layout, Point& h);

/// Computes residual = H z + h. Returns the largest relative error of an equation: |residual| over the largest sum of
/// |terms| in its block and knot (0 / 0 is 0), or NaN if a term is NaN. scale: workspace.
double kkt_residual(const Problem& problem, const Layout& layout, const Regularisation& reg, const Point& z,
                    Point& residual, Point& scale);

double kkt_error(const Problem& problem, const Point& z, const Regularisation& reg = {});

/// The change of the cost without regularisation, cost(z) - cost(0) = linear + quadratic / 2, at the optimum z with
/// `reg`. cost_change uses the optimality conditions, and no products with matrices.
struct Change {
  double linear = 0, quadratic = 0;
};
Change cost_change(const Problem& problem, const Layout& layout, const Regularisation& reg, const Point& z);

}  // namespace manycontact::lq
