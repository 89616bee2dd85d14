#pragma once
// A factor of an island's K, whatever its kind. One file each: ldl, proximal, cholmod, dense,
// dense_schur.

#include <algorithm>
#include <limits>
#include <span>

#include "manycontact/kkt/matrix.hpp"
#include "manycontact/kkt/reason.hpp"
#include "manycontact/kkt/shape.hpp"
#include "manycontact/rank/pivots.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

/// Scratch memory that factorizations share, one after the other.
struct FactorScratch {
  sparse::LdlWorkspace ldl;
  std::vector<double> scale;                      // sizes of the pivots' terms
  std::vector<rank::PassedOn<double>> passed_on;  // one entry per row of K
  /// Input, of each row of J, in the island's order: the largest motion it is picked from (rank/row_size.hpp), which it
  /// is judged relative to. If the length differs, all are K.row_scale.
  std::vector<double> row_scale;
};

struct PanelWork;  // kkt/factor/refined.hpp

class Factor {  // one island's factor, whatever the method
 public:
  virtual ~Factor() = default;

  virtual Method method() const = 0;
  /// Numeric factorization; K must outlive its use. kNone: sound. Otherwise why not, and nothing else may be called.
  [[nodiscard]] virtual Reason factorize(const KktMatrix& K, FactorScratch& scratch) = 0;

  /// x <- K^-1 x, in K's order of elimination. With dependent rows (damping 0) the generalised inverse that gives
  /// least-squares accelerations and least-norm forces.
  virtual void solve(double* x) = 0;
  /// The same for a solution's residual, b - K x, where b has no part P b (project_out): of dependent rows those kept
  /// alone. No correction of x removes the rounding errors of J x in the others.
  virtual void correct(double* r) { solve(r); }
  /// v.x <- K^-1 v.b, refined by at most max_steps corrections of the true residual; v.r and v.scale are those of x.
  /// Where rows are dependent, their inconsistency is taken out of b meanwhile, and left in v.null_component.
  virtual sparse::Refinement solve_refined(const KktMatrix& K, KktVectors& v, int max_steps);
  /// The componentwise backward error of that (sparse/refine.hpp). Dropped rows, sums of z_j times rows kept, are
  /// judged relative to |z_j| times these rows' scale.
  virtual double backward_error(std::span<const double> r, std::span<const double> scale) {
    return sparse::componentwise_backward_error(r, scale);
  }
  /// solve for columns first ... first+cols-1 of a row-major panel with row stride ld, rows in the island's order.
  /// nonzero: a flag per row of K, in order of elimination, set where a row of X is not zero in these columns;
  /// overwritten. A factor may make use of zeros or not.
  virtual void solve_panel(double* X, int ld, int first, int cols, char* nonzero) = 0;

  /// The same refined once, for the K factorized: X + K^-1 (B - K X) where solve_panel gives X = K^-1 B. work.nonzero:
  /// its flags; work.B: as large as X.
  virtual void solve_panel_refined(const KktMatrix& K, double* X, int ld, int first, int cols, PanelWork& work);

  /// Releases the memory that only solve_panel needs, until solve_panel is called again.
  virtual void release_panels() {}

  /// Rank of J.
  virtual int rank() const = 0;
  /// Rows of J, numbered within the island, that depend on the others: nc - rank of them, in any order.
  virtual void dependent_rows(std::vector<int>& rows) const { rows.clear(); }
  /// Let P be the projector on the null space of J^T. y -= P y on the contact rows; P y is written to null_component if
  /// that is not null (K's size, zero elsewhere). Does nothing if rank() is nc.
  virtual void project_out(double* y, double* null_component) { (void)y, (void)null_component; }
  /// Does the same as project_out for all columns of a panel, stored as in solve_panel.
  virtual void project_out_panel(double* X, int ld, int cols) { (void)X, (void)ld, (void)cols; }
  /// A flag per row of J, numbered within the island (rows: nc): set where y -= P y may change it, and it others.
  virtual void null_space_rows(std::span<char> rows) const { std::fill(rows.begin(), rows.end(), 1); }

  /// Residual of the dropped rows relative to the terms of the rank decision, if it may exceed rounding errors.
  virtual double left_of_dropped_rows() const { return 0; }

  /// Rounding error of the projections relative to the largest entry of y, which limits the forces of least norm.
  virtual double projector_error() const { return 0; }

  /// Nonzeros of the factor, diagonals included.
  virtual int nonzeros() const = 0;
  /// If J y = f has a solution y (f: the contacts' rows of x), one of them takes the place of x's other rows; the
  /// contacts' rows are overwritten.
  virtual void particular_solution(double* x) { solve(x); }

  /// Steps of refinement that solve and solve_panel make by themselves; their solutions are then final.
  virtual int own_refinements() const { return 0; }
  /// Growth of K's entries during elimination: the largest term of a pivot over the largest diagonal of K. The backward
  /// error of an unrefined solve is about eps times that, for some right-hand sides if not for the current one.
  virtual double growth() const { return 1; }
  /// A bound of the backward error |dK|_1 / |K|_1 of every column that solve_panel gives, whatever the right-hand side;
  /// infinite where none is known. K: the one factorized.
  virtual double panel_error(const KktMatrix& K) {
    (void)K;
    return std::numeric_limits<double>::infinity();
  }
  /// Whether a panel's columns are as accurate as a single solve. Then growth and the backward error of the single
  /// solve decide whether the panel needs refinement. Otherwise panels are judged by their own residual.
  virtual bool panel_is_like_solve() const { return true; }
};

/// n (n + 1) / 2, or the largest number there is.
inline int numbers_of_triangle(int n) {
  return static_cast<int>(std::min(0.5 * n * (n + 1.0), static_cast<double>(std::numeric_limits<int>::max())));
}

}  // namespace manycontact
