#pragma once
// A = L D L^T of a symmetric matrix in the order given, by SuiteSparse's LDL. No pivoting: whether the pivots were
// sound is for the caller to judge from D (its signs are A's inertia) and from pivot_terms. Source: Davis,
// Algorithm 849: a concise sparse Cholesky factorization package (2005).

#include <vector>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

/// Analysis of the pattern alone. Constant; shared by all matrices of the pattern.
struct LdlSymbolic {
  int n = 0;
  std::vector<int> parent;      // elimination tree
  std::vector<int> Lp, Li;      // L without its unit diagonal, by columns, rows ascending
  std::vector<int> Rp, Rj, Rk;  // the same by rows: row k has columns Rj[Rp[k]...] ascending, values at Lx[Rk[...]]
  double flops = 0;             // cost of the numeric phase: sum of squared column counts, without relaxed zeros

  int nonzeros() const { return Lp.empty() ? 0 : Lp.back(); }
  /// Column k's pattern is k + 1 and that of column k + 1.
  bool nests(int k) const { return k + 1 < n && parent[k] == k + 1 && Lp[k + 1] - Lp[k] == Lp[k + 2] - Lp[k + 1] + 1; }
};

/// Scratch memory of factorization, for matrices up to the largest it was made for.
struct LdlWorkspace {
  std::vector<double> Y;
  std::vector<int> pattern, flag, Lnz, Li;
  void reserve(const LdlSymbolic& symbolic);
};

LdlSymbolic ldl_analyze(const UpperCsc& A);
/// Fills Rp, Rj, Rk from the columns' rows. The columns of a row are in ascending order; each column precedes those
/// that depend on it.
void list_rows(LdlSymbolic& L);

/// L's size as that analysis would find it, in the terms of LdlSymbolic.
struct LdlCounts {
  double nonzeros = 0, flops = 0;
  // once columns whose patterns are nearly one share it (sparse/relaxed_supernodes.hpp): blocks of columns, and the sum
  // of their rows below squared, entries that a block changes elsewhere
  double blocks = 0, scattered = 0;
};
/// Takes time and memory of A's entries, however many L has. Source: Gilbert, Ng, Peyton, An efficient algorithm to
/// compute row and column counts for sparse Cholesky factorization (1994).
LdlCounts ldl_count(const UpperCsc& A);

/// Lx: nonzeros(), D: n. Returns n, or the column whose pivot is exactly zero (then L, D are not usable).
/// Allocates nothing once the workspace is large enough.
[[nodiscard]] int ldl_factor(const UpperCsc& A, const LdlSymbolic& symbolic, const double* Ax, LdlWorkspace& work,
                             double* Lx, double* D);

/// Factorizes A row by row with the library's own elimination. Also computes the terms of the pivots, scale[k] = |A_kk|
/// + sum_j L_kj^2 |D_j| (n). A row whose pivot is at most least[k] scale[k] is not eliminated: its column of L is zero.
/// Elimination continues after a pivot that is zero or NaN: the caller checks D and scale.
void ldl_factor_by_rows(const UpperCsc& A, const LdlSymbolic& symbolic, const double* Ax, const double* least,
                        LdlWorkspace& work, double* Lx, double* D, double* scale);

/// x <- A^-1 x.
void ldl_solve(const LdlSymbolic& symbolic, const double* Lx, const double* D, double* x);

/// X <- A^-1 X for the columns first ... first+cols-1 of a row-major panel with row stride ld; row k of A's order is
/// row row[k] of X. nonzero: n flags in A's order, set where a row of X is not zero (in these columns); overwritten.
/// Zero rows cost nothing in the forward sweep. row, nonzero may be nullptr: rows in A's order, any of them nonzero.
void ldl_solve_panel(const LdlSymbolic& symbolic, const double* Lx, const double* D, const int* row, double* X, int ld,
                     int first, int cols, char* nonzero);

/// The terms of the pivots, terms_k = |A_kk| + sum_j L_kj^2 |D_j| (n): a pivot of eps times its terms is noise.
void pivot_terms(const UpperCsc& A, const LdlSymbolic& symbolic, const double* Ax, const double* Lx, const double* D,
                 double* terms);

/// c such that whatever is solved for with a computed factor solves (A + dA) x = b, |dA| <= c |L||D||L^T|: so the
/// backward error of every column of a panel is bounded beforehand. Each entry of L D L^T and each row of the two
/// sweeps is a sum of products, in any order, with at most so many roundings u = eps/2. Source: Higham, Accuracy and
/// Stability of Numerical Algorithms, 2nd edition, lemma 8.4, theorems 9.3 and 9.4.
double ldl_rounding(const LdlSymbolic& symbolic);

}  // namespace manycontact::sparse
