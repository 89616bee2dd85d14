#pragma once
// L D L^T of K = [M J^T; J 0] whose rows J may be dependent. Rows without a pivot are dropped. Vectors are in K's
// elimination order; of_M flags rows of M, which may follow a row of J if earlier rows of M give it a pivot.
//
// For a dropped row k, K's factor without row k gives z with J_k = sum_j z_j J_j over the kept rows: L^T z = row k of
// L, in rows of J before k. The columns n_k = e_k - z of N span the null space of J^T. With P = N (N^T N)^-1 N^T,
//
//   [a; y] = (I - P) K_kept^-1 (I - P) [b1; b2]
//
// solves M a + J^T y = b1, J a = b2 in the least-squares sense (Euclidean norm), with y of least norm.

#include <span>

#include "manycontact/rank/waiting_rows.hpp"
#include "manycontact/sparse/ldl.hpp"

namespace manycontact::rank {

struct DependentRows {          // the dropped rows, the null space basis N and its projector
  std::vector<int> dropped;     // rows of K: first rows flagged in `plain`, then dependent waiting rows, each ascending
  std::vector<char> turned;     // one flag per row of K: dropped by an exchange, may depend on later rows; may be empty
  WaitingRows waiting;          // kept rows without a sound pivot in K's order, and rows that depend on them
  std::vector<char> plain;      // one flag per dropped row: the residual of its column of N is only rounding error
  std::vector<int> Np, Ni;      // N, a column per dropped row: column k's rows of K are Ni[Np[k]] ...
  std::vector<double> Nx;       // values of N, by columns; the first is the dropped row's own 1
  double largest_residual = 0;  // max |J_k - sum z_j J_j| relative to the largest |n_j| times the size of row j
  double largest_entry = 0;     // max |z_j|
  double largest_projected = 0;  // max |z_j| of columns that are not orthonormalised; eps z_j^2 is the error of P
  int largest_cluster = 0;       // largest number of entries of a cluster's B

  /// Whether the dropped rows depend on the kept rows: after find_null_space, J^T N is a rounding error (kRowLeft), and
  /// columns of N that are not orthonormalised have no large z_j (kLargestEntry).
  bool accepted() const;

  /// Dropped rows whose columns of N share rows. The projector of a cluster uses the smaller of two bases B: its
  /// columns N = [1; -Z], in dropped and kept rows, or a basis [Z^T; 1] of their orthogonal complement.
  struct Cluster {
    int first = 0, count = 0;  // range in `members`
    int row = 0, row_end = 0;  // range in `cluster_rows` of the rows of K in which its columns of N have entries
    int basis = 0, size = 0;   // the cluster's columns of B: basis ... basis + size - 1
    // `kind` states what they are: columns of N, their complement, or N orthonormalised, as large entries require.
    enum { kColumns, kComplement, kOrthonormal } kind = kColumns;
    std::size_t gram = 0;  // offset in DependentRows::gram of the Cholesky factor of B^T B, size x size, by columns
  };
  std::vector<Cluster> clusters;
  std::vector<int> members;  // indices in `dropped`, cluster by cluster
  std::vector<int> cluster_rows;
  std::vector<int> Bp, Bi;  // columns of all clusters' bases B, stored as N is
  std::vector<double> Bx, gram;

  // scratch
  std::vector<double> least, terms, x, panel, t;
  std::vector<int> owner;
  static constexpr int kColumns = 8;  // columns of a panel; a panel has one row for each row of K
  std::vector<double> N, residual;    // panels: kColumns columns of N, and J^T times these
  std::vector<int> of_N, touched;     // the only rows in which N, and in which residual, may be nonzero
  std::vector<char> met;              // one flag per row of K: the row is listed in of_N or touched
  std::vector<int> Jp, Ji;            // entries of row k of J in columns after k: pairs (slot, column) at Ji[Jp[k]] ...
  bool M_first = true;                // whether no row of M follows a row of J
};

/// Computes least (n): a row waits (is not eliminated with the others) if its pivot is below `least` times the pivot's
/// terms. A row of J waits if its pivot, or its largest entry, is at most `margin` times its rounding error
/// (rank/pivots.hpp). row_size: n sizes of J's rows.
void least_pivots(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M, double margin,
                  const double* row_size, std::vector<double>& least);

/// Lists the waiting rows in `dropped`, after a factorization with pivots D and their terms. D of waiting rows becomes
/// infinite, so that ldl_solve gives zero there. Returns n, or the first row without a sound pivot: a row of M, a row
/// of J with the wrong sign, or a row beyond `most` waiting rows. rows.least is an input.
[[nodiscard]] int take_waiting_rows(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M, int most,
                                    const double* terms, double* D, DependentRows& rows);

/// Calls least_pivots, factorizes row by row, and calls take_waiting_rows.
[[nodiscard]] int ldl_factor_dependent(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                                       std::span<const char> of_M, double margin, const double* row_size,
                                       sparse::LdlWorkspace& work, double* Lx, double* D, DependentRows& rows);

/// Computes N and its projector for the rows in rows.dropped. row_scale: sizes of rows of J; solve: applies K_kept^-1
/// by L and D. Sets largest_entry, and largest_residual, which is a rounding error if the rows are dependent.
void find_null_space(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                     std::span<const char> of_M, const double* row_scale, const double* Lx, const SolvePanel& solve,
                     DependentRows& rows);

void make_projector(int n, DependentRows& rows);  // computed from N; n: rows of K

/// After find_null_space, exchanges dropped rows with kept rows until no entry of N exceeds kExchanged, except in large
/// clusters. Returns whether rows were exchanged; the caller must then factorize again.
[[nodiscard]] bool exchange_rows(DependentRows& rows);

/// After ldl_factor_dependent: finds the dependent waiting rows, N and its projector. Certainly dependent rows are
/// dropped; others join the kept rows unless their Schur complement shows dependence. False: rounding hides the rank.
[[nodiscard]] bool find_dependence(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                                   std::span<const char> of_M, const double* row_size, const double* Lx,
                                   const double* D, const SolvePanel& solve, DependentRows& rows);

/// Overwrites X with K_kept^-1 X, by `solve` (with L and D) and the Schur complement of the waiting rows. X: the first
/// `cols` columns of a row-major panel with row stride ld.
void solve_kept(DependentRows& rows, double* X, int ld, int cols, const SolvePanel& solve);

/// Returns the sizes relative to which residuals are judged, from scale = |b| + |K| |x| (n). For a dropped row it is
/// |N|^T scale, since errors of kept rows reach it with the coefficients z_j. The memory is that of `rows`.
std::span<const double> scale_of_dependent(DependentRows& rows, std::span<const double> scale);

/// Subtracts P y from y (n, in K's order), and adds P y to null_component (n) if given. Rows of M are not used.
void project_out(DependentRows& rows, double* y, double* null_component = nullptr);
/// Subtracts P X from X in columns first ... first+cols-1 of a row-major panel with row stride ld. Row k of K is row
/// row[k] of X. nonzero: one flag per row of K, which is read and updated: the row may be nonzero in these columns.
void project_out_panel(DependentRows& rows, const int* row, double* X, int ld, int first, int cols,
                       char* nonzero = nullptr);

}  // namespace manycontact::rank
