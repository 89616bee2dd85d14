#pragma once
// L D L^T of a saddle point matrix K = [M J^T; J 0] whose rows J may depend on each other: rows with nothing left of
// their pivot are dropped, and the null space of J^T shows how they depend on the rows kept. Everything in K's order of
// elimination, of which flags of_M mark the rows of M: all first, or some after rows of J, where these must have
// their pivots from the rows of M before them.
//
// For a dropped row k, K's factor without it gives z with J_k = sum_j z_j J_j over the rows kept: L^T z = l_k, of which
// the part of M vanishes, so only the rows of J before k are solved for. The columns n_k = e_k - z of N span the null
// space of J^T. With the orthogonal projector P = N (N^T N)^-1 N^T on it,
//
//   [a; y] = (I - P) K_kept^-1 (I - P) [b1; b2]
//
// solves M a + J^T y = b1 with a least-squares J a = b2 (Euclidean norm), M-orthogonal to J's null space, and y of
// least norm: the solution that rank-revealing dense methods give, in a few more operations than a sparse solve.

#include <span>

#include "manycontact/rank/waiting_rows.hpp"
#include "manycontact/sparse/ldl.hpp"

namespace manycontact::rank {

/// Storage is kept between factorizations: nothing is allocated for a matrix of the same pattern and dependences.
struct DependentRows {
  std::vector<int> dropped;     // rows of K: those that plainly depend, then those that wait and depend, each ascending
  std::vector<char> turned;     // flags of K's rows: dropped in another's place, it may depend on later ones. Or empty
  WaitingRows waiting;          // rows without a sound pivot that are kept all the same, and those that depend on them
  std::vector<char> plain;      // flags of dropped rows: that row alone would be accepted
  std::vector<int> Np, Ni;      // N by columns, one per dropped row: rows of K ...
  std::vector<double> Nx;       // ... and values, the 1 of the dropped row first
  double largest_residual = 0;  // max |J_k - sum z_j J_j|, relative to the rows' largest size, that of j times |z_j|
  double largest_entry = 0;     // max |z_j|
  double largest_projected =
      0;                    // the same where columns are not made orthonormal: the projector loses its square, in eps
  int largest_cluster = 0;  // most entries of B that project a row, see Cluster

  /// Whether the rows dropped depend on those kept in truth, by numbers that the projector can take: what J's rows
  /// leave is rounding, and no z_j is large where columns were not made orthonormal (kRowLeft, kLargestEntry in
  /// tolerances.hpp). After find_null_space; else rounding errors hide which rows are dependent.
  bool accepted() const;

  /// Dropped rows whose columns of N share rows. They are projected by whichever is smaller: these columns, or those of
  /// the complement, which [Z; 1] spans in the rows dropped and kept where N is [1; -Z].
  struct Cluster {
    int first = 0, count = 0;  // range in `members`
    int row = 0, row_end = 0;  // range in `cluster_rows`: rows of K that N has there
    int basis = 0, size = 0;   // columns of B ...
    // ... which are N's, or span the complement, or are N's made orthonormal, since N has large entries
    enum { kColumns, kComplement, kOrthonormal } kind = kColumns;
    std::size_t gram = 0;  // offset in `gram`: size x size, by columns: the Cholesky factor of B^T B
  };
  std::vector<Cluster> clusters;
  std::vector<int> members;  // positions in `dropped`
  std::vector<int> cluster_rows;
  std::vector<int> Bp, Bi;  // the clusters' columns, as N's
  std::vector<double> Bx, gram;

  // scratch
  std::vector<double> least, terms, x, panel, t;
  std::vector<int> owner;
  static constexpr int kColumns = 8;  // of panels, which have a row for each row of K
  std::vector<double> N, residual;    // some columns of N, and J^T times these: panels, zero but in the rows listed
  std::vector<int> of_N, touched;     // rows of N, and of residual
  std::vector<char> met;              // flags of the rows listed
  std::vector<int> Jp, Ji;  // entries of row k of J, from Jp[k] on: K's slots and columns in the rows of M after it
  bool M_first = true;      // no row of M comes after one of J
};

/// What a factor of K (n rows) asks of the pivots, relative to their terms, into `least` (n): a row of J waits where no
/// more than `margin` times rounding is left of its pivot or of the row itself (rank/pivots.hpp), a row of M never.
/// row_size: n, unused for rows of M.
void least_pivots(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M, double margin,
                  const double* row_size, std::vector<double>& least);

/// After that factor, whose pivots D have these terms: lists the rows that wait in `dropped`, and makes their D
/// infinite, so that ldl_solve gives zero there. Returns n, or the first row without a sound pivot: one of M, or one of
/// J whose pivot has the wrong sign, or that would wait after `most` others. rows.least is an input.
[[nodiscard]] int take_waiting_rows(const sparse::UpperCsc& K, const double* Kx, std::span<const char> of_M, int most,
                                    const double* terms, double* D, DependentRows& rows);

/// Both, and the factor row by row.
[[nodiscard]] int ldl_factor_dependent(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                                       std::span<const char> of_M, double margin, const double* row_size,
                                       sparse::LdlWorkspace& work, double* Lx, double* D, DependentRows& rows);

/// N and its projector of the rows that `dropped` lists; row_scale: as row_size there. Sets largest_residual, which is
/// rounding when these rows depend on the others in truth, and largest_entry. solve: by L and D.
void find_null_space(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                     std::span<const char> of_M, const double* row_scale, const double* Lx, const SolvePanel& solve,
                     DependentRows& rows);

/// The clusters and their projectors, of N of n rows.
void make_projector(int n, DependentRows& rows);

/// Other rows to drop, after find_null_space: those of a cluster take turns with rows of its null space until no entry
/// is larger than kExchanged (tolerances.hpp), as N by another basis would have them. To be factorized and judged
/// again. False where nothing was exchanged, or a cluster is too large for that.
[[nodiscard]] bool exchange_rows(DependentRows& rows);

/// Which of the rows that wait depend on the others, after ldl_factor_dependent. Those that do not plainly depend on
/// rows before them join the rows kept by their Schur complement; only those that depend on the rows kept are dropped
/// in the end. Then N and its projector. False where rounding hides which rows depend.
[[nodiscard]] bool find_dependence(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                                   std::span<const char> of_M, const double* row_size, const double* Lx,
                                   const double* D, const SolvePanel& solve, DependentRows& rows);

/// X <- K_kept^-1 X: `solve`, by L and D, with the waiting rows.
void solve_kept(DependentRows& rows, double* X, int ld, int cols, const SolvePanel& solve);

/// Sizes that residuals are judged relative to, from scale |b| + |K| |x| (n): for a row that was dropped, |N|^T scale,
/// since rows kept leave z_j times what they leave themselves. In memory of `rows`.
std::span<const double> scale_of_dependent(DependentRows& rows, std::span<const double> scale);

/// y -= P y, and P y into `null_component` when it is given (n, zero outside J's rows). y: n, in K's order; rows of M
/// unused.
void project_out(DependentRows& rows, double* y, double* null_component = nullptr);
/// The same for the columns first ... first+cols-1 of a row-major panel with row stride ld; row k of K is row[k] of X.
/// nonzero: a flag per row of K, set where that of X is not zero in these columns; kept so. nullptr: all may be.
void project_out_panel(DependentRows& rows, const int* row, double* X, int ld, int first, int cols,
                       char* nonzero = nullptr);

}  // namespace manycontact::rank
