#pragma once
// The interface of all factors of an island's K.

#include <algorithm>
#include <limits>
#include <span>

#include "manycontact/kkt/matrix.hpp"
#include "manycontact/kkt/reason.hpp"
#include "manycontact/kkt/shape.hpp"
#include "manycontact/rank/pivots.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

/// Scratch memory for factorizations, which successive factorizations share.
struct FactorScratch {
  sparse::LdlWorkspace ldl;
  std::vector<double> scale;                      // magnitudes of the pivots' terms
  std::vector<rank::PassedOn<double>> passed_on;  // one entry per row of K
  /// Input: one number per row of J in the island's order, the largest motion from which the row is selected
  /// (rank/row_size.hpp), relative to which it counts as zero or dependent. K.row_scale replaces these numbers unless
  /// there are nc of them.
  std::vector<double> row_scale;
};

struct PanelWork;  // kkt/factor/refined.hpp

class Factor {
 public:
  virtual ~Factor() = default;

  virtual Method method() const = 0;
  /// Factorizes K, which must exist as long as the factor is used. The factor must be used only if the result is kNone.
  [[nodiscard]] virtual Reason factorize(const KktMatrix& K, FactorScratch& scratch) = 0;

  /// Overwrites x with K^-1 x, in K's elimination order. If rows are dependent (damping 0), K^-1 is the generalised
  /// inverse that gives least-squares accelerations and least-norm forces.
  virtual void solve(double* x) = 0;
  /// Overwrites a residual r = b - K x, where b has no part P b (project_out), with the correction K^-1 r of x. Only
  /// the kept rows count, since no correction can remove rounding errors of J x in the dependent rows.
  virtual void correct(double* r) { solve(r); }
  /// Computes v.x = K^-1 v.b with at most max_steps corrections from the true residual, and sets v.r and v.scale. If
  /// rows are dependent, v.null_component becomes the inconsistent part P b, which is not part of b during the solve.
  virtual sparse::Refinement solve_refined(const KktMatrix& K, KktVectors& v, int max_steps);
  /// Returns the componentwise backward error of r. The scale of a dropped (dependent) row includes those of the kept
  /// rows j that it depends on, times their coefficients' |z_j|.
  virtual double backward_error(std::span<const double> r, std::span<const double> scale) {
    return sparse::componentwise_backward_error(r, scale);
  }
  /// Solves for columns first ... first+cols-1 of a row-major panel with row stride ld, rows in the island's order.
  /// nonzero: flags of K's rows, in elimination order, where these columns may be nonzero; overwritten.
  virtual void solve_panel(double* X, int ld, int first, int cols, char* nonzero) = 0;

  /// Solves as solve_panel does, refined once by X + K^-1 (B - K X). work.nonzero: flags; work.B: memory as large as X.
  virtual void solve_panel_refined(const KktMatrix& K, double* X, int ld, int first, int cols, PanelWork& work);

  virtual void release_panels() {}  // a later solve_panel allocates again

  virtual int rank() const = 0;
  /// Lists the nc - rank dependent rows of J, numbered within the island, in any order.
  virtual void dependent_rows(std::vector<int>& rows) const { rows.clear(); }
  /// Subtracts P y from the contact rows of y, with the projector P on the null space of J^T. Adds P y to
  /// null_component (one entry per row of K) unless it is nullptr. Does nothing if J has full rank.
  virtual void project_out(double* y, double* null_component) { (void)y, (void)null_component; }
  /// Subtracts P X (P: see project_out) from the first `cols` columns of a panel X, stored as in solve_panel.
  virtual void project_out_panel(double* X, int ld, int cols) { (void)X, (void)ld, (void)cols; }
  /// Sets one flag per row of J, numbered within the island (nc), if project_out may change the row.
  virtual void null_space_rows(std::span<char> rows) const { std::fill(rows.begin(), rows.end(), 1); }

  /// Returns the largest residual of dropped rows relative to the terms that decided the rank; 0: only rounding errors.
  virtual double left_of_dropped_rows() const { return 0; }

  /// Returns the rounding error of project_out relative to the largest |y_k|; it bounds that of least-norm forces.
  virtual double projector_error() const { return 0; }

  virtual int nonzeros() const = 0;  // number of entries of the factor, with diagonals
  /// Overwrites the coordinates' rows of x with a solution y of J y = f, if any, where f are the contact rows of x.
  virtual void particular_solution(double* x) { solve(x); }

  /// Returns the number of refinement steps of solve and solve_panel; if above 0, callers do not refine further.
  virtual int own_refinements() const { return 0; }
  /// Returns the growth of K's entries during elimination: the largest term of a pivot over the largest diagonal entry
  /// of K. The backward error of an unrefined solve is about eps times the growth for some right-hand sides.
  virtual double growth() const { return 1; }
  /// Returns a bound of the backward error |dK|_1 / |K|_1 of any column from solve_panel, or infinity if unknown.
  virtual double panel_error(const KktMatrix& K) {
    (void)K;
    return std::numeric_limits<double>::infinity();
  }
  /// Whether the columns of a panel are as accurate as a single solve. If so, growth() and the error of a single solve
  /// decide whether panels are refined. Otherwise, the panels' own residuals decide.
  virtual bool panel_is_like_solve() const { return true; }
};

/// Returns n (n + 1) / 2, or the largest int if that is larger.
inline int numbers_of_triangle(int n) {
  return static_cast<int>(std::min(0.5 * n * (n + 1.0), static_cast<double>(std::numeric_limits<int>::max())));
}

}  // namespace manycontact
