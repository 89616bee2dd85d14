#pragma once
// Kernels on sparse factors and on row-major panels of doubles with row stride ld, compiled for several SIMD levels,
// one of which is chosen at run time. Results of different levels agree up to rounding errors. In functions from
// upper_product on, ld is a multiple of eight, at least cols.

#include <cstddef>
#include <span>

#include "manycontact/sparse/ldl_schedule.hpp"

namespace manycontact::sparse {

/// Returns n rounded up to a multiple of eight, which is the length of the rows of a panel with n columns.
constexpr int padded(std::ptrdiff_t n) { return static_cast<int>((n + 7) / 8 * 8); }

struct PanelKernels {
  const char* name;
  int columns;  // columns of a panel that are computed at a time
  /// ldl_scheduled_factor (ldl_kernels.hpp), where a row with a pivot of at most least[k] scale[k] is not eliminated.
  /// least may be nullptr. The factorization ends with the block in which the number of such rows exceeds `most`.
  void (*factor)(const LdlSchedule& schedule, const double* Ax, const double* least, int most, double* Lx, double* D,
                 double* scale);
  /// Compute ldl_scheduled_solve (ldl_kernels.hpp) for doubles, and residual (upper_csc.hpp).
  void (*solve_vector)(const LdlSchedule& schedule, const double* Lx, const double* D, double* x);
  void (*residual_vector)(const UpperCsc& A, const double* Ax, const double* x, const double* b, double* r,
                          double* scale);
  /// X <- A^-1 X, arguments as in ldl_solve_panel (ldl.hpp). work: work_size(schedule) doubles.
  void (*solve)(const LdlSchedule& schedule, const double* Lx, const double* D, const int* row, double* X, int ld,
                int first, int cols, char* nonzero, double* work);
  /// Overwrites right-hand sides X = B with A^-1 B, refined once by X + A^-1 (B - A X); arguments as in `solve`.
  void (*solve_refined)(const LdlSchedule& schedule, const UpperCsc& A, const double* Ax, const double* Lx,
                        const double* D, const int* row, double* X, int ld, int first, int cols, char* nonzero,
                        double* work);
  /// B -= A X in columns 0 ... cols-1 of panels with row stride ld; row k of A is row row[k] of X and B.
  void (*residual)(const UpperCsc& A, const double* Ax, const int* row, const double* X, double* B, int ld, int cols);
  /// Computes the upper triangle of H = L^T R (ld x ld; L, R: depth x ld) in blocks of eight rows, in `cols` columns.
  void (*upper_product)(const double* L, const double* R, int depth, int cols, int ld, double* H);
  /// H = L^T R, with the first `rows` columns of L (depth x ldl) and the first `cols` columns of R (depth x ld) and H.
  void (*product)(const double* L, int ldl, const double* R, int depth, int rows, int cols, int ld, double* H);
  /// Computes `product`, with row k of R at R + from[k] ld and row i of H at H + to[i] ld. non_temporal: stores bypass
  /// the caches, as H is larger than these. H must then start at a cache line, and ld be a multiple of eight.
  void (*product_of_rows)(const double* L, int ldl, const double* R, const int* from, int depth, double* H,
                          const int* to, int rows, int cols, int ld, bool non_temporal);
  /// X <- L^-1 X (lower_solve) or L^-T X (upper_solve), for the n x n Cholesky factor L, whose column j starts at L + j
  /// ldl. X is n x ld; its first `cols` columns are used, with ld >= cols a multiple of eight.
  void (*lower_solve)(const double* L, int ldl, int n, double* X, int cols, int ld);
  void (*upper_solve)(const double* L, int ldl, int n, double* X, int cols, int ld);

  std::size_t work_size(const LdlSchedule& schedule) const {
    return static_cast<std::size_t>(schedule.n) * static_cast<std::size_t>(2 * columns + 2) + schedule.packed.size() +
           8;
  }
};

const PanelKernels& panel_kernels();                  // the widest level that the processor supports
std::span<const PanelKernels* const> panel_levels();  // all levels the processor supports, the widest first

}  // namespace manycontact::sparse
