#pragma once
// CHOLMOD's simplicial LDL' in three calls: analyse a pattern once, factorize values often, solve. Source: Chen, Davis,
// Hager, Rajamanickam, Algorithm 887: CHOLMOD (2008).
//
// Only constructors allocate memory. std::bad_alloc leaves objects usable; other failures throw std::runtime_error.

#include <memory>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

/// The symbolic analysis of a pattern, without reordering. It is constant, and several threads' Cholmod may share it.
class CholmodSymbolic {
 public:
  explicit CholmodSymbolic(const UpperCsc& pattern);
  ~CholmodSymbolic();
  CholmodSymbolic(const CholmodSymbolic&) = delete;
  CholmodSymbolic& operator=(const CholmodSymbolic&) = delete;

  int size() const;
  int factor_nonzeros() const;

 private:
  friend class Cholmod;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The factor of one symmetric matrix with nonzero leading minors (e.g. quasi-definite), and one thread's workspace.
class Cholmod {
 public:
  explicit Cholmod(std::shared_ptr<const CholmodSymbolic> symbolic);
  ~Cholmod();
  Cholmod(Cholmod&&) noexcept;
  Cholmod& operator=(Cholmod&&) noexcept;

  /// Factorizes the matrix with entries Ax, in the order of the pattern's entries. Returns false if a pivot is zero.
  [[nodiscard]] bool factorize(const double* Ax);
  void solve(double* X, int cols);  // X <- A^-1 X; X: n x cols, column-major
  void pivots(double* D) const;     // n pivots, in the order of elimination
  /// Computes terms[k] = |A_kk| + sum_j L_kj^2 |D_j|, the magnitude of the terms of pivot k, for all n pivots.
  void pivot_terms(const double* Ax, double* terms) const;
  const CholmodSymbolic& symbolic() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace manycontact::sparse
