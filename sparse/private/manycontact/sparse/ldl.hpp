#pragma once
// A = L D L^T of a symmetric matrix in the given order, without pivoting, by SuiteSparse's LDL. The caller judges the
// pivots by D, whose signs give A's signature, and by pivot_terms. Source: Davis, Algorithm 849: a concise sparse
// Cholesky factorization package (2005).

#include <vector>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

/// Symbolic analysis of a pattern: constant, and shared by all matrices with that pattern.
struct LdlSymbolic {
  int n = 0;
  std::vector<int> parent;      // elimination tree
  std::vector<int> Lp, Li;      // L without its unit diagonal, by columns: Lp column starts, Li rows, ascending
  std::vector<int> Rp, Rj, Rk;  // L by rows: row k has columns Rj[Rp[k]...] ascending, values at Lx[Rk[...]]
  double flops = 0;             // cost of the numeric phase: sum of squared column counts, without zeros of supernodes

  int nonzeros() const { return Lp.empty() ? 0 : Lp.back(); }
  /// Whether the pattern of column k consists of row k + 1 and the pattern of column k + 1.
  bool nests(int k) const { return k + 1 < n && parent[k] == k + 1 && Lp[k + 1] - Lp[k] == Lp[k + 2] - Lp[k + 1] + 1; }
};

/// Workspace of a factorization; a larger matrix enlarges it.
struct LdlWorkspace {
  std::vector<double> Y;
  std::vector<int> pattern, flag, Lnz, Li;
  void reserve(const LdlSymbolic& symbolic);
};

LdlSymbolic ldl_analyze(const UpperCsc& A);
/// Fills Rp, Rj, Rk from Lp and Li. Columns of a row are ascending: each precedes the columns that depend on it.
void list_rows(LdlSymbolic& L);

/// The size of L that ldl_analyze would find; members as in LdlSymbolic.
struct LdlCounts {
  double nonzeros = 0, flops = 0;
  // For relaxed supernodes (sparse/relaxed_supernodes.hpp), blocks: number of blocks of columns; scattered: sum of
  // (rows below)^2 over the blocks, the entries that blocks update in other columns.
  double blocks = 0, scattered = 0;
};
/// Computes LdlCounts in time and memory proportional to A's entries. Source: Gilbert, Ng, Peyton, An efficient
/// algorithm to compute row and column counts for sparse Cholesky factorization (1994).
LdlCounts ldl_count(const UpperCsc& A);

/// Computes Lx (nonzeros()) and D (n). Returns n, or the first column whose pivot is exactly zero; L and D are then
/// unusable. Allocates nothing once the workspace is large enough.
[[nodiscard]] int ldl_factor(const UpperCsc& A, const LdlSymbolic& symbolic, const double* Ax, LdlWorkspace& work,
                             double* Lx, double* D);

/// Factorizes A row by row with the library's own elimination, and computes the terms of the pivots, scale[k] = |A_kk|
/// + sum_j L_kj^2 |D_j| (n). A row whose pivot is at most least[k] scale[k] is not eliminated: its column of L is zero.
/// Elimination continues after a pivot that is zero or NaN; the caller checks D and scale.
void ldl_factor_by_rows(const UpperCsc& A, const LdlSymbolic& symbolic, const double* Ax, const double* least,
                        LdlWorkspace& work, double* Lx, double* D, double* scale);

/// x <- A^-1 x, from A's factor.
void ldl_solve(const LdlSymbolic& symbolic, const double* Lx, const double* D, double* x);

/// X <- A^-1 X for columns first ... first+cols-1 of a row-major panel with row stride ld; row k of A is row row[k] of
/// X, or k if row is nullptr. nonzero: n flags in A's order, set where a row of X is nonzero in these columns;
/// overwritten. Zero rows cost nothing in the forward sweep. If nonzero is nullptr, all rows may be nonzero.
void ldl_solve_panel(const LdlSymbolic& symbolic, const double* Lx, const double* D, const int* row, double* X, int ld,
                     int first, int cols, char* nonzero);

/// Computes terms_k = |A_kk| + sum_j L_kj^2 |D_j| of the pivots (n). A pivot of eps times its terms is noise.
void pivot_terms(const UpperCsc& A, const LdlSymbolic& symbolic, const double* Ax, const double* Lx, const double* D,
                 double* terms);

/// Returns c such that each solution x by a computed factor solves (A + dA) x = b exactly, with |dA| <= c |L||D||L^T|.
/// This bounds the backward error of every column of a panel in advance. c counts the roundings u = eps/2 of each entry
/// of L D L^T and of each row of both sweeps, sums of products in any order. Source: Higham, Accuracy and Stability of
/// Numerical Algorithms, 2nd edition, lemma 8.4, theorems 9.3 and 9.4.
double ldl_rounding(const LdlSymbolic& symbolic);

}  // namespace manycontact::sparse
