#pragma once
// L D L^T of a saddle point matrix K = [M J^T; J 0] with possibly dependent rows J: rows without a remaining pivot are
// dropped, and the null space of J^T gives their dependence on the kept rows. Everything is in K's elimination order,
// and of_M flags the rows of M. Rows of M may follow a row of J if earlier rows of M give that row its pivot.
//
// For a dropped row k, K's factor without it gives z with J_k = sum_j z_j J_j over the kept rows: L^T z = l_k, solved
// in rows of J before k. The columns n_k = e_k - z of N span the null space of J^T. With P = N (N^T N)^-1 N^T,
//
//   [a; y] = (I - P) K_kept^-1 (I - P) [b1; b2]
//
// solves M a + J^T y = b1 with least-squares J a = b2 (Euclidean norm), M-orthogonal to J's null space, and y of least
// norm, as rank-revealing dense methods do, at little more than the cost of a sparse solve.

#include <span>

#include "manycontact/rank/waiting_rows.hpp"
#include "manycontact/sparse/ldl.hpp"

namespace manycontact::rank {

/// Memory is reused: nothing is allocated for the same pattern and dependences.
struct DependentRows {
  std::vector<int> dropped;     // rows of K: plainly dependent ones, then waiting dependent ones, each ascending
  std::vector<char> turned;     // one flag per row of K: dropped by an exchange, may depend on later rows; or empty
  WaitingRows waiting;          // rows without a sound pivot that are kept, and rows that depend on them
  std::vector<char> plain;      // one flag per dropped row: whether the residual of its column of N is a rounding error
  std::vector<int> Np, Ni;      // N by columns, one per dropped row: rows of K, ...
  std::vector<double> Nx;       // values, the dropped row's 1 first
  double largest_residual = 0;  // max |J_k - sum z_j J_j| relative to the largest |n_j| times the size of row j
  double largest_entry = 0;     // max |z_j|
  double largest_projected =
      0;                    // max |z_j| of columns not orthonormalised: the projector's error is eps times its square
  int largest_cluster = 0;  // largest number of entries of B in a cluster

  /// Whether the dropped rows depend on the kept ones with tolerable coefficients, after find_null_space: residuals of
  /// J are rounding errors, and no z_j is large in columns not orthonormalised (kRowLeft, kLargestEntry).
  bool accepted() const;

  /// Dropped rows whose columns of N share rows. They are projected by the smaller basis: these columns, or those of
  /// the complement, spanned by [Z; 1] in dropped and kept rows, where N is [1; -Z].
  struct Cluster {
    int first = 0, count = 0;  // range in `members`
    int row = 0, row_end = 0;  // range in `cluster_rows`: rows of K in which N has entries
    int basis = 0, size = 0;   // columns of B, ...
    // ... which are N's, a basis of the complement, or N's orthonormalised because of large entries
    enum { kColumns, kComplement, kOrthonormal } kind = kColumns;
    std::size_t gram = 0;  // offset in `gram` of the Cholesky factor of B^T B, size x size, by columns
  };
  std::vector<Cluster> clusters;
  std::vector<int> members;  // indices in `dropped`
  std::vector<int> cluster_rows;
  std::vector<int> Bp, Bi;  // the clusters' columns, stored as N
  std::vector<double> Bx, gram;

  // scratch
  std::vector<double> least, terms, x, panel, t;
  std::vector<int> owner;
  static constexpr int kColumns = 8;  // columns of panels, which have a row for each row of K
  std::vector<double> N, residual;    // panels: some columns of N, and J^T times these; zero except in these rows:
  std::vector<int> of_N, touched;     // rows in which N, and residual, may be nonzero
  std::vector<char> met;              // one flag per row of K: listed in of_N or touched
  std::vector<int> Jp, Ji;            // entries of row k of J, from Jp[k] on: K's slots, and columns in later rows of M
  bool M_first = true;                // whether no row of M follows a row of J
};

/// Sets least (n), the pivots required relative to their terms: a row of J waits if its pivot or the row itself does
/// not exceed `margin` times rounding (rank/pivots.hpp), a row of M never. row_size: n, unused for rows of M.
void least_pivots(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M, double margin,
                  const double* row_size, std::vector<double>& least);

/// Lists the waiting rows in `dropped` after the factorization, with pivots D and their terms, and sets their D to
/// infinity so that ldl_solve gives zero there. Returns n, or the first row without a sound pivot: one of M, one of J
/// with the wrong sign, or one beyond `most` waiting rows. rows.least is an input.
[[nodiscard]] int take_waiting_rows(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M, int most,
                                    const double* terms, double* D, DependentRows& rows);

/// Calls least_pivots, factorizes row by row, and calls take_waiting_rows.
[[nodiscard]] int ldl_factor_dependent(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                                       std::span<const char> of_M, double margin, const double* row_size,
                                       sparse::LdlWorkspace& work, double* Lx, double* D, DependentRows& rows);

/// Computes N and its projector for the rows in `dropped`; row_scale: as row_size above; solve: by L and D. Sets
/// largest_residual, which is rounding error if these rows are dependent, and largest_entry.
void find_null_space(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                     std::span<const char> of_M, const double* row_scale, const double* Lx, const SolvePanel& solve,
                     DependentRows& rows);

/// Computes the clusters and their projectors for N with n rows.
void make_projector(int n, DependentRows& rows);

/// Exchanges dropped rows of a cluster with rows of its null space, after find_null_space, until no entry exceeds
/// kExchanged (tolerances.hpp). The caller factorizes again. False: nothing was exchanged, or a cluster is too large.
[[nodiscard]] bool exchange_rows(DependentRows& rows);

/// Determines which waiting rows are dependent, after ldl_factor_dependent. Rows that are not plainly dependent on
/// earlier rows join the kept ones by their Schur complement; only rows that depend on all kept ones are dropped.
/// Computes N and its projector. False: rounding hides which rows are dependent.
[[nodiscard]] bool find_dependence(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                                   std::span<const char> of_M, const double* row_size, const double* Lx,
                                   const double* D, const SolvePanel& solve, DependentRows& rows);

/// Overwrites X with K_kept^-1 X: `solve`, by L and D, with the waiting rows.
void solve_kept(DependentRows& rows, double* X, int ld, int cols, const SolvePanel& solve);

/// Returns the sizes relative to which residuals are judged, from scale |b| + |K| |x| (n): for a dropped row |N|^T
/// scale, since errors of kept rows are transferred with z_j. The memory is that of `rows`.
std::span<const double> scale_of_dependent(DependentRows& rows, std::span<const double> scale);

/// Sets y -= P y, and null_component = P y (n) if given. y: n, in K's order; rows of M are unused.
void project_out(DependentRows& rows, double* y, double* null_component = nullptr);
/// Does the same for columns first ... first+cols-1 of a row-major panel with row stride ld; row k of K is row[k] of X.
/// nonzero: one flag per row of K, set and updated if its row of X is nonzero in these columns; nullptr: all may be.
void project_out_panel(DependentRows& rows, const int* row, double* X, int ld, int first, int cols,
                       char* nonzero = nullptr);

}  // namespace manycontact::rank
