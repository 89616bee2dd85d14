#pragma once
// The body-space system and its factor.

#include "manycontact/kkt/bodies/ldl.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

struct BodySolve {
  BodyVectors b, x, dx;
  BodyResidual residual;
  void resize(const BodyPattern& p);
};

/// Solves for x, refined with residuals of bodies and their parents, so that rounding does not accumulate along chains.
sparse::Refinement solve_refined(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps);
/// Does the same after factorize_bodies lifted b.
sparse::Refinement solve_lifted(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps);

/// Returns the number of entries of a factor, as Factor::nonzeros.
int nonzeros(const BodyPattern& pattern, const BodyLdl& ldl);

/// Factor and solves of a body-space system, with vectors and panels in the island's order.
class BodyFactor {
 public:
  /// Does not allocate memory; make_room does.
  explicit BodyFactor(std::shared_ptr<const BodyPattern> pattern) { system.pattern = std::move(pattern); }
  void make_room();

  BodySystem system;
  BodyLdl ldl;

  /// Solves without refinement.
  void solve(double* x);
  /// Solves for X of `cols` columns, row-major, column by column with refinement; NaN if that does not converge.
  void solve_panel(double* X, int cols);

 private:
  BodySolve work_;
  bool has_room_ = false;
};

}  // namespace manycontact
