#pragma once
// CHOLMOD in three calls: analyse a pattern once, factorize values often, solve. Source: Chen, Davis, Hager,
// Rajamanickam, Algorithm 887: CHOLMOD (2008).
//
// Memory is taken by the constructors. After them solve allocates nothing, nor does factorize of kSimplicialLdl;
// factorize of kSupernodalLlt makes and frees two blocks each time, the update matrix of cholmod_super_numeric, which
// offers no way to keep it, and a threaded BLAS may add its own.
//
// All throw std::bad_alloc when memory runs out, and may be called again afterwards; std::runtime_error where CHOLMOD
// refuses for another reason (sizes beyond its integers).

#include <memory>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

enum class CholmodKind {
  kSimplicialLdl,  // LDL' of a symmetric matrix with leading minors that are not zero, e.g. quasi-definite
  kSupernodalLlt,  // LL' of a positive definite matrix; needs the GPL part of CHOLMOD
};

/// Whether kSupernodalLlt was built in (option MANYCONTACT_GPL).
bool supernodal_available();

/// What the pattern alone determines. Constant: any number of Cholmods may share one, in any number of threads.
class CholmodSymbolic {
 public:
  /// `order_rows`: let CHOLMOD choose the order (AMD); otherwise the rows stay as they are. Throws
  /// std::invalid_argument for kSupernodalLlt where that is not built in.
  CholmodSymbolic(const UpperCsc& pattern, CholmodKind kind, bool order_rows);
  ~CholmodSymbolic();
  CholmodSymbolic(const CholmodSymbolic&) = delete;
  CholmodSymbolic& operator=(const CholmodSymbolic&) = delete;

  CholmodKind kind() const;
  int size() const;
  /// Non-zeros of the factor, diagonal included, and operations of the numeric phase.
  int factor_nonzeros() const;
  double flops() const;

 private:
  friend class Cholmod;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The factor of one matrix, and the memory to solve with it: one thread at a time.
class Cholmod {
 public:
  /// Analyses nothing.
  explicit Cholmod(std::shared_ptr<const CholmodSymbolic> symbolic);
  /// With a symbolic phase of its own.
  Cholmod(const UpperCsc& pattern, CholmodKind kind, bool order_rows);
  ~Cholmod();
  Cholmod(Cholmod&&) noexcept;
  Cholmod& operator=(Cholmod&&) noexcept;

  /// Numeric factorization of the values Ax in the pattern's slots. False when a pivot is zero (not positive for LL').
  [[nodiscard]] bool factorize(const double* Ax);
  /// X <- A^-1 X, X an n x cols matrix by columns.
  void solve(double* X, int cols);
  /// After kSimplicialLdl: copies the n pivots to D, in the order of elimination.
  void pivots(double* D) const;
  /// After kSimplicialLdl: as smallest_pivot_ratio in ldl.hpp. scale: n, scratch.
  double smallest_pivot_ratio(const double* Ax, double* scale) const;
  /// Estimate of the reciprocal condition number from the factor's diagonal.
  double rcond() const;
  const CholmodSymbolic& symbolic() const;
  /// As CholmodSymbolic's.
  int factor_nonzeros() const;
  double flops() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace manycontact::sparse
