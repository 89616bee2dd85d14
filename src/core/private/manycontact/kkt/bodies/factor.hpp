#pragma once

#include "manycontact/kkt/bodies/ldl.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

struct BodySolve {
  BodyVectors b, x, dx;
  BodyResidual residual;
  void resize(const BodyPattern& p);
};

/// Solves for v.x with right-hand sides v.b. Residuals of each body's equations keep rounding local in chains.
sparse::Refinement solve_refined(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps);
sparse::Refinement solve_lifted(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps);  // 

int nonzeros(const BodyPattern& pattern, const BodyLdl& ldl);  // entries of the factor

/// A body-space system with its factor, and solves in joint space, with vectors and panels in the island's order.
class BodyFactor {
 public:
  /// Allocates no memory. Call make_room, which does, before other functions.
  explicit BodyFactor(std::shared_ptr<const BodyPattern> pattern) { system.pattern = std::move(pattern); }
  void make_room();

  BodySystem system;
  BodyLdl ldl;

  void solve(double* x);
  /// Overwrites a row-major X with K^-1 X, column by column with refinement; columns that do not converge become NaN.
  void solve_panel(double* X, int cols);

 private:
  BodySolve work_;
  bool has_room_ = false;
};

}  // namespace manycontact
