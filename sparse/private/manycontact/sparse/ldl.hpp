#pragma once
// A = L D L^T of a symmetric matrix in the given order, without pivoting, by SuiteSparse's LDL. Callers must check the
// pivots. Source: Davis, Algorithm 849: a concise sparse Cholesky factorization package (2005).

#include <vector>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

struct LdlSymbolic {  // symbolic analysis of a pattern; constant
  int n = 0;
  std::vector<int> parent;      // elimination tree: parent of each column, -1 for a root
  std::vector<int> Lp, Li;      // L without its unit diagonal, by columns: Lp column starts, Li rows, ascending
  std::vector<int> Rp, Rj, Rk;  // L by rows: row k has columns Rj[Rp[k]...] ascending, values at Lx[Rk[...]]
  double flops = 0;             // numeric cost: sum of squared column counts, without the zeros of relaxed supernodes

  int nonzeros() const { return Lp.empty() ? 0 : Lp.back(); }
  /// Whether the pattern of column k consists of row k + 1 and the pattern of column k + 1.
  bool nests(int k) const { return k + 1 < n && parent[k] == k + 1 && Lp[k + 1] - Lp[k] == Lp[k + 2] - Lp[k + 1] + 1; }
};

/// The workspace of a factorization. It grows when a larger matrix is factorized.
struct LdlWorkspace {
  std::vector<double> Y;
  std::vector<int> pattern, flag, Lnz, Li;
  void reserve(const LdlSymbolic& symbolic);
};

LdlSymbolic ldl_analyze(const UpperCsc& A);
void list_rows(LdlSymbolic& L);  // computes Rp, Rj, Rk from Lp and Li

struct LdlCounts {  // size of the factor that ldl_analyze would find; nonzeros, flops: see LdlSymbolic
  double nonzeros = 0, flops = 0;
  // blocks: the number of relaxed supernodes (sparse/relaxed_supernodes.hpp), which are blocks of columns.
  // scattered: the sum over blocks of (rows below)^2, about the number of entries of other columns that blocks update.
  double blocks = 0, scattered = 0;
};
/// Computes LdlCounts in time and memory proportional to A's entries. Source: Gilbert, Ng, Peyton, An efficient
/// algorithm to compute row and column counts for sparse Cholesky factorization (1994).
LdlCounts ldl_count(const UpperCsc& A);

/// Computes Lx (symbolic.nonzeros() values) and D (n values), and returns n. If a pivot is exactly zero, returns its
/// column instead, and Lx and D are unusable. Allocates nothing once the workspace is large enough.
[[nodiscard]] int ldl_factor(const UpperCsc& A, const LdlSymbolic& symbolic, const double* Ax, LdlWorkspace& work,
                             double* Lx, double* D);

/// Factorizes row by row, without SuiteSparse, and sets scale (n) to the terms of pivots (pivot_terms). A row k with a
/// pivot of at most least[k] scale[k] is not eliminated (its column of L is zero). The factorization continues after
/// zero or NaN pivots, so that callers must check D and scale.
void ldl_factor_by_rows(const UpperCsc& A, const LdlSymbolic& symbolic, const double* Ax, const double* least,
                        LdlWorkspace& work, double* Lx, double* D, double* scale);

void ldl_solve(const LdlSymbolic& symbolic, const double* Lx, const double* D, double* x);  // x <- A^-1 x

/// X <- A^-1 X for columns first ... first+cols-1 of a row-major panel with row stride ld. Row k of A is row row[k] of
/// X, or row k if row is nullptr. nonzero: n flags in A's order, set for rows of X that are nonzero in these columns;
/// the function overwrites them. Zero rows cost nothing in the forward sweep. Without flags, all may be nonzero.
void ldl_solve_panel(const LdlSymbolic& symbolic, const double* Lx, const double* D, const int* row, double* X, int ld,
                     int first, int cols, char* nonzero);

/// Computes terms[k] = |A_kk| + sum_j L_kj^2 |D_j| (n), the terms of pivot k, whose rounding error is eps terms[k].
void pivot_terms(const UpperCsc& A, const LdlSymbolic& symbolic, const double* Ax, const double* Lx, const double* D,
                 double* terms);

/// Returns c such that computed solutions x solve (A + dA) x = b exactly, with |dA| <= c |L||D||L^T|. c counts
/// roundings (eps/2 each) for sums in any order. Source: Higham, Accuracy and Stability of Numerical Algorithms, 2nd
/// edition, lemma 8.4, theorems 9.3 and 9.4.
double ldl_rounding(const LdlSymbolic& symbolic);

}  // namespace manycontact::sparse
