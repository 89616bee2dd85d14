#pragma once
// The optimality conditions H z + h = 0, z = (x, u, w, lambda, mu), H symmetric, by which solvers are judged.

#include "manycontact/lq/problem.hpp"

namespace manycontact::lq {

/// Sets h: q in x, r in u and w, (x0, f of knots 0 ... T-1) in lambda, d in mu.
void linear_terms(const Problem& problem, const Layout& layout, Point& h);

/// Computes residual = H z + h. Returns the largest error over the equations: |residual| relative to the largest sum of
/// |terms| in its block (of a knot); 0 if all terms are 0, NaN if any is NaN. `scale`: workspace of the same sizes.
double kkt_residual(const Problem& problem, const Layout& layout, const Regularisation& reg, const Point& z,
                    Point& residual, Point& scale);

/// Returns the error of kkt_residual; allocates its own workspace.
double kkt_error(const Problem& problem, const Point& z, const Regularisation& reg = {});

/// The change of cost by the optimum z of the problem under `reg`: cost(z) - cost(0) = linear + quadratic / 2, of the
/// problem without regularisation. It is computed with vectors alone, from the optimality conditions.
struct Change {
  double linear = 0, quadratic = 0;
};
Change cost_change(const Problem& problem, const Layout& layout, const Regularisation& reg, const Point& z);

}  // namespace manycontact::lq
