#pragma once
// Interface of all factors of an island's K; each kind has its own file: ldl, proximal, cholmod, dense, dense_schur.

#include <algorithm>
#include <limits>
#include <span>

#include "manycontact/kkt/matrix.hpp"
#include "manycontact/kkt/reason.hpp"
#include "manycontact/kkt/shape.hpp"
#include "manycontact/rank/pivots.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

/// Scratch memory that successive factorizations share.
struct FactorScratch {
  sparse::LdlWorkspace ldl;
  std::vector<double> scale;                      // magnitudes of the pivots' terms
  std::vector<rank::PassedOn<double>> passed_on;  // one entry per row of K
  /// Input: per row of J, in the island's order, the largest motion it is selected from (rank/row_size.hpp), relative
  /// to which it is judged. If the length differs, K.row_scale is used for all.
  std::vector<double> row_scale;
};

struct PanelWork;  // kkt/factor/refined.hpp

class Factor {
 public:
  virtual ~Factor() = default;

  virtual Method method() const = 0;
  /// Factorizes K, which must outlive the factor's use. If not kNone, it is not sound and must not be used.
  [[nodiscard]] virtual Reason factorize(const KktMatrix& K, FactorScratch& scratch) = 0;

  /// Overwrites x with K^-1 x, in K's elimination order. With dependent rows (damping 0) it is the generalised inverse
  /// that gives least-squares accelerations and least-norm forces.
  virtual void solve(double* x) = 0;
  /// Does the same for a residual b - K x, where b has no part P b (project_out), with only the kept rows: no
  /// correction of x can remove the rounding errors of J x in the dependent ones.
  virtual void correct(double* r) { solve(r); }
  /// Solves v.x = K^-1 v.b with at most max_steps corrections by the true residual; sets v.r and v.scale. With
  /// dependent rows, their inconsistency is moved from b to v.null_component during the solve.
  virtual sparse::Refinement solve_refined(const KktMatrix& K, KktVectors& v, int max_steps);
  /// Returns the componentwise backward error (sparse/refine.hpp); dropped rows relative to |z_j| times kept rows'
  /// scale.
  virtual double backward_error(std::span<const double> r, std::span<const double> scale) {
    return sparse::componentwise_backward_error(r, scale);
  }
  /// Solves for columns first ... first+cols-1 of a row-major panel with row stride ld, rows in the island's order.
  /// nonzero: flags of K's rows, in elimination order, where these columns may be nonzero; overwritten, may be ignored.
  virtual void solve_panel(double* X, int ld, int first, int cols, char* nonzero) = 0;

  /// Does the same with one refinement, X + K^-1 (B - K X). work.nonzero: the flags; work.B: as large as X.
  virtual void solve_panel_refined(const KktMatrix& K, double* X, int ld, int first, int cols, PanelWork& work);

  /// Releases the memory that only solve_panel needs, until solve_panel is called again.
  virtual void release_panels() {}

  /// Rank of J.
  virtual int rank() const = 0;
  /// Returns the nc - rank dependent rows of J, numbered within the island, in any order.
  virtual void dependent_rows(std::vector<int>& rows) const { rows.clear(); }
  /// Sets y -= P y on the contact rows, P the projector on the null space of J^T, and null_component = P y if it is not
  /// nullptr (K's size, zero elsewhere). Does nothing if rank() is nc.
  virtual void project_out(double* y, double* null_component) { (void)y, (void)null_component; }
  /// Does the same for all columns of a panel, stored as in solve_panel.
  virtual void project_out_panel(double* X, int ld, int cols) { (void)X, (void)ld, (void)cols; }
  /// Sets one flag per row of J, numbered within the island (nc): whether y -= P y may involve the row.
  virtual void null_space_rows(std::span<char> rows) const { std::fill(rows.begin(), rows.end(), 1); }

  /// Returns the residual of dropped rows relative to the terms of the rank decision, if it may exceed rounding errors.
  virtual double left_of_dropped_rows() const { return 0; }

  /// Returns the rounding error of projections relative to the largest entry of y; it limits least-norm forces.
  virtual double projector_error() const { return 0; }

  /// Returns the number of nonzeros of the factor, diagonals included.
  virtual int nonzeros() const = 0;
  /// If J y = f (f: contact rows of x) has a solution, overwrites x's other rows with one, and its contact rows.
  virtual void particular_solution(double* x) { solve(x); }

  /// Returns the refinement steps that solve and solve_panel make themselves; their solutions are then final.
  virtual int own_refinements() const { return 0; }
  /// Returns the growth of K's entries during elimination: the largest term of a pivot over the largest diagonal entry
  /// of K. The backward error of an unrefined solve is about eps times that for some right-hand sides.
  virtual double growth() const { return 1; }
  /// Returns a bound of the backward error |dK|_1 / |K|_1 of all columns from solve_panel, or infinity. K: factorized.
  virtual double panel_error(const KktMatrix& K) {
    (void)K;
    return std::numeric_limits<double>::infinity();
  }
  /// Whether panel columns are as accurate as a single solve. Growth and the single solve's error then decide whether
  /// panels are refined; otherwise panels are judged by their own residual.
  virtual bool panel_is_like_solve() const { return true; }
};

/// Returns n (n + 1) / 2, or the largest int.
inline int numbers_of_triangle(int n) {
  return static_cast<int>(std::min(0.5 * n * (n + 1.0), static_cast<double>(std::numeric_limits<int>::max())));
}

}  // namespace manycontact
