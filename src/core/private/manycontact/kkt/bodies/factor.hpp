#pragma once

#include "manycontact/kkt/bodies/ldl.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

struct BodySolve {
  BodyVectors b, x, dx;
  BodyResidual residual;
  void resize(const BodyPattern& p);
};

/// Solves for v.x with right-hand sides v.b. Refines with the residuals of each body's own equations, so that rounding
/// errors do not add up along chains.
sparse::Refinement solve_refined(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps);
/// Solves as solve_refined does, but without the first backward sweep, which factorize_bodies did with b = v.b.
sparse::Refinement solve_lifted(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps);

int nonzeros(const BodyPattern& pattern, const BodyLdl& ldl);  // number of entries of the factor

/// A body-space system with its factor, and solves in joint space, with vectors and panels in the island's order.
class BodyFactor {
 public:
  /// Allocates no memory. Call make_room, which does, before other functions.
  explicit BodyFactor(std::shared_ptr<const BodyPattern> pattern) { system.pattern = std::move(pattern); }
  void make_room();

  BodySystem system;
  BodyLdl ldl;

  void solve(double* x);  // x <- K^-1 x, without refinement
  /// Overwrites a row-major X with K^-1 X, column by column with refinement; columns that do not converge become NaN.
  void solve_panel(double* X, int cols);

 private:
  BodySolve work_;
  bool has_room_ = false;
};

}  // namespace manycontact
