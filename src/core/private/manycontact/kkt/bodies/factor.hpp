#pragma once
// The body-space system and its factor.

#include "manycontact/kkt/bodies/ldl.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

/// Memory of a refined solve.
struct BodySolve {
  BodyVectors b, x, dx;
  BodyResidual residual;
  void resize(const BodyPattern& p);
};

/// Solves for x with right-hand side b and refines it with residuals of the whole system. Each residual involves a body
/// and its parent only, so that rounding errors do not accumulate along a chain.
sparse::Refinement solve_refined(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps);
/// Solves and refines likewise, after factorize_bodies lifted b.
sparse::Refinement solve_lifted(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps);

/// Numbers kept of a factor, as Factor::nonzeros.
int nonzeros(const BodyPattern& pattern, const BodyLdl& ldl);

/// Factor and solves of a body-space system. Vectors and panels are in the island's order: there is no K to permute.
class BodyFactor {
 public:
  /// Does not allocate memory; make_room does.
  explicit BodyFactor(std::shared_ptr<const BodyPattern> pattern) { system.pattern = std::move(pattern); }
  void make_room();

  BodySystem system;
  BodyLdl ldl;

  /// Solves without refinement.
  void solve(double* x);
  /// X of `cols` columns, row by row: column by column, refined; NaN where that does not converge.
  void solve_panel(double* X, int cols);

 private:
  BodySolve work_;
  bool has_room_ = false;
};

}  // namespace manycontact
