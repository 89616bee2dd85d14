#pragma once
// The body-space system (system.hpp) and its factor (ldl.hpp), with vectors and panels in the island's order.

#include "manycontact/kkt/bodies/ldl.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

struct BodySolve {
  BodyVectors b, x, dx;
  BodyResidual residual;
  void resize(const BodyPattern& p);
};

/// Solves for v.x, refined with the residuals of single bodies, so that rounding errors do not add up along chains.
sparse::Refinement solve_refined(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps);
/// Solves as solve_refined does, after factorize_bodies was called with b = v.b, so without the first backward sweep.
sparse::Refinement solve_lifted(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps);

/// Returns the number of entries of a factor, for Factor::nonzeros.
int nonzeros(const BodyPattern& pattern, const BodyLdl& ldl);

/// Factor and solves of a body-space system, with vectors and panels in the island's order.
class BodyFactor {
 public:
  /// Allocates no memory; call make_room before other functions.
  explicit BodyFactor(std::shared_ptr<const BodyPattern> pattern) { system.pattern = std::move(pattern); }
  void make_room();

  BodySystem system;
  BodyLdl ldl;

  /// Overwrites x with K^-1 x, without refinement.
  void solve(double* x);
  /// Overwrites a row-major X with K^-1 X, column by column with refinement; columns that do not converge become NaN.
  void solve_panel(double* X, int cols);

 private:
  BodySolve work_;
  bool has_room_ = false;
};

}  // namespace manycontact
