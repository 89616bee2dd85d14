#pragma once
// CHOLMOD in three calls: analyse a pattern once, factorize values often, solve. Source: Chen, Davis, Hager,
// Rajamanickam, Algorithm 887: CHOLMOD (2008).
//
// Memory is taken by the constructors. After them kSimplicialLdl allocates nothing, nor does kSupernodalLlt to solve
// for one column. These allocations remain:
//  * factorize: cholmod_super_numeric makes and frees its update matrix, two blocks;
//  * where CHOLMOD is built with OpenMP, as Debian's is, that routine enters parallel regions for each supernode, and
//    GNU's OpenMP takes and frees 1.5 KB for most of them (they run in one thread; others run in four, whatever
//    OMP_NUM_THREADS is: OMP_THREAD_LIMIT=1 stops that);
//  * the BLAS takes memory as it likes: OpenBLAS does with several threads (not with OPENBLAS_NUM_THREADS=1), and for
//    small products on machines with AVX-512.
//
// Where memory runs out std::bad_alloc is thrown, and the same object may be called again; OpenMP and OpenBLAS end the
// program instead. std::runtime_error where CHOLMOD refuses for another reason (sizes beyond its integers).

#include <memory>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

enum class CholmodKind {
  kSimplicialLdl,  // LDL' of a symmetric matrix with leading minors that are not zero, e.g. quasi-definite
  kSupernodalLlt,  // LL' of a positive definite matrix; needs the GPL part of CHOLMOD
};

/// Whether kSupernodalLlt was built in (option MANYCONTACT_GPL).
bool supernodal_available();

/// Analysis of the pattern alone. Constant: any number of Cholmods may share one, in any number of threads.
class CholmodSymbolic {
 public:
  /// `order_rows`: let CHOLMOD choose the order (AMD); otherwise the rows stay as they are. Throws
  /// std::invalid_argument for kSupernodalLlt where that is not built in.
  CholmodSymbolic(const UpperCsc& pattern, CholmodKind kind, bool order_rows);
  ~CholmodSymbolic();
  CholmodSymbolic(const CholmodSymbolic&) = delete;
  CholmodSymbolic& operator=(const CholmodSymbolic&) = delete;

  int size() const;
  /// Non-zeros of the factor, diagonal included.
  int factor_nonzeros() const;

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
  /// Analyses the pattern as well.
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
  /// After kSimplicialLdl: as pivot_terms in ldl.hpp (n).
  void pivot_terms(const double* Ax, double* terms) const;
  /// After kSupernodalLlt: the n pivots as parts of their diagonal entries, in the order of elimination.
  void parts_left(double* left) const;
  const CholmodSymbolic& symbolic() const;
  /// The same number as CholmodSymbolic's.
  int factor_nonzeros() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace manycontact::sparse
