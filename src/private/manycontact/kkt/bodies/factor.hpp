#pragma once
// The body-space system as a factor of K among others.

#include "manycontact/kkt/bodies/ldl.hpp"
#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

/// Memory of a refined solve.
struct BodySolve {
  BodyVectors b, x, dx;
  BodyResidual residual;
  void resize(const BodyPattern& p);
};

/// x of b, refined with residuals of the whole system. Each of them touches a body and its parent only, so no rounding
/// adds up along a chain. lifted: factorize_bodies did so with b.
sparse::Refinement solve_refined(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps,
                                 bool lifted = false);

/// Numbers kept of a factor, as Factor::nonzeros.
int nonzeros(const BodyPattern& pattern, const BodyLdl& ldl);

/// Its vectors and panels are in the island's order: there is no K, and no order of elimination to permute to.
class BodyFactor final : public Factor {
 public:
  /// Without memory until make_room.
  explicit BodyFactor(std::shared_ptr<const BodyPattern> pattern) { system.pattern = std::move(pattern); }
  void make_room();

  BodySystem system;
  BodyLdl ldl;

  Method method() const override { return Method::kSparseBodies; }
  /// Of `system`; K is not looked at.
  [[nodiscard]] Reason factorize(const KktMatrix& K, FactorScratch& scratch) override;
  /// Not refined.
  void solve(double* x) override;
  /// Column by column, refined; NaN where that does not converge.
  void solve_panel(double* X, int ld, int first, int cols, char* nonzero) override;
  int own_refinements() const override { return 1; }
  int rank() const override { return system.pattern->nc; }
  int nonzeros() const override { return manycontact::nonzeros(*system.pattern, ldl); }
  double growth() const override { return ldl.growth; }

 private:
  BodySolve work_;
  bool has_room_ = false;
};

}  // namespace manycontact
