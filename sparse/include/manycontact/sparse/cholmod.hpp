#pragma once
// CHOLMOD behind two calls: analyse a pattern once, factorize values often. CHOLMOD allocates workspace of its own
// during the first factorizations. Source: Chen, Davis, Hager, Rajamanickam, Algorithm 887: CHOLMOD (2008).

#include <memory>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

enum class CholmodKind {
  kSimplicialLdl,  // LDL' of a symmetric matrix with leading minors that are not zero, e.g. quasi-definite
  kSupernodalLlt,  // LL' of a positive definite matrix; needs the GPL part of CHOLMOD
};

/// Whether kSupernodalLlt was built in (option MANYCONTACT_GPL).
bool supernodal_available();

class Cholmod {
 public:
  /// Symbolic analysis. `order_rows`: let CHOLMOD choose the order; otherwise the rows stay as they are.
  Cholmod(const UpperCsc& pattern, CholmodKind kind, bool order_rows);
  ~Cholmod();
  Cholmod(Cholmod&&) noexcept;
  Cholmod& operator=(Cholmod&&) noexcept;

  /// Numeric factorization of the values Ax in the pattern's slots. False when a pivot is zero (not positive for LL').
  [[nodiscard]] bool factorize(const double* Ax);
  /// X <- A^-1 X, X an n x cols matrix by columns.
  void solve(double* X, int cols);
  /// After kSimplicialLdl: copies the n pivots to D.
  void pivots(double* D) const;
  /// After kSimplicialLdl: as smallest_pivot_ratio in ldl.hpp. scale: n, scratch.
  double smallest_pivot_ratio(const double* Ax, double* scale) const;
  /// Estimate of the reciprocal condition number from the factor's diagonal.
  double rcond() const;
  /// Non-zeros of the factor, diagonal included.
  int factor_nonzeros() const;
  double flops() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace manycontact::sparse
