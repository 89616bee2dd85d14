#pragma once
// Status and accuracy of a solution, available in every build type.

#include <limits>
#include <string>
#include <vector>

#include "manycontact/kkt/options.hpp"
#include "manycontact/kkt/reason.hpp"

namespace manycontact {

/// The value of an estimate that was not computed: NaN.
inline constexpr double kNotEstimated = std::numeric_limits<double>::quiet_NaN();

/// Times of a solve [us]. They are measured and differ from call to call; comparisons of reports ignore them.
struct SolveTimes {
  double setup = 0;  // finding islands and analysing new ones; near 0 if no contact was switched
  double solve = 0;  // kinematics, bias, assembly, factorization, solution, refinement and residuals
};

/// The quality of a solution, from best to worst. The status of a scene is the status of its worst island.
enum class Status {
  kOk,
  kRedundant,     // contacts are redundant and consistent: accelerations are exact, forces have least norm
  kInconsistent,  // contacts are inconsistent: the accelerations are the least-squares solution
  kRegularised,   // the solution solves a slightly different problem, e.g. without a damping below rounding errors
  kFailed,        // there is no solution: accelerations and forces are NaN
};
std::string to_string(Status status);  // "ok", "redundant", ...

struct IslandReport {  // Status and accuracy of the solution of one island.
  Status status = Status::kOk;
  Method method = Method::kSparseLdl;        // the method that computed the solution
  Order order = Order::kLeafToRoot;          // the elimination order of the method, if it has one
  Reason reason = Reason::kNone;             // why order or method changed, or why the solve failed; or kUncertain
  Precision precision = Precision::kDouble;  // the precision of the solution
  bool changed_order = false;                // the chosen order was not accurate, and leaf-to-root was used instead
  int nv = 0, nc = 0;
  int rank = 0;                     // rank of J; nc with damping, which makes K regular; 0 if failed
  std::vector<int> dependent_rows;  // only without damping: the nc - rank rows of data.f that depend on the others,
                                    // ascending
  int factor_nonzeros = 0;          // nonzeros of the factors, diagonals included
  int refinement_steps = 0;
  // Residuals of the equations M a - J^T f = tau_b and J a + a0 + delta f = 0, relative to the terms of the equations.
  double residual_dynamics = 0;  // max |M a - J^T f - tau_b| / max (|M||a| + |J^T||f| + |tau_b|)
  double residual_contact = 0;   // max |J a + a0 + delta f| / max (|J||a| + |a0| + delta |f|, |gravity|)
  double contact_terms = 0;      // max (|J||a| + |a0| + delta |f|): the scale in the test for inconsistency
  double backward_error = 0;     // max |r_k| / (|b| + |K||x|)_k, r = b - K x: the relative change of K and b with which
                                 // the solution is exact. After a fallback, rows that contain only rounding errors are
                                 // divided by the terms from which they were computed
  double condition = kNotEstimated;  // 1-norm condition number of K, set by estimate_condition; until then NaN
  /// Bounds of the largest errors of a and of f, relative to the largest a and f, set by estimate_errors; until then
  /// NaN. If a bound is above 1, no digit is certain. Either a and f are rounding errors, such as the accelerations of
  /// a scene at rest, or they solve a slightly different problem (Reason::kUncertain).
  double error_acceleration = kNotEstimated, error_forces = kNotEstimated;
};

/// Measures of the accuracy of the solution x of the linear system K x = b of an island, and of the conditioning of K.
/// K has one row per contact row that the solver keeps (at most six between two bodies), in the solver's units. All
/// numbers are NaN for failed islands and for deep trees whose K is too large.
struct SystemQuality {
  /// The backward error max_k |r_k| / (|K| |x| + |b|)_k, r = b - K x: the smallest relative change of K's and b's
  /// entries with which x is exact (Oettli, Prager, Numer. Math. 6, 1964). Divisors are at least eps times the largest
  /// divisor.
  double componentwise_backward_error;
  /// The backward error |r| / (|K| |x| + |b|) in the maximum norm: the smallest change of K and b, relative to their
  /// norms, that makes x exact (Rigal, Gaches, J. ACM 14, 1967).
  double normwise_backward_error;
  /// The pivot growth: the largest term in the sum of any pivot, divided by the largest diagonal entry of K. It is 1
  /// for the dense factor.
  double growth;
  /// The estimated condition number |K|_1 |K^-1|_1, with the generalised inverse K^+ instead of K^-1 if K is singular.
  double condition;
  /// The condition number of D K D, with the diagonal matrix D for which the largest entry of each row is about 1
  /// (Ruiz, RAL-TR-2001-034). Units (metres and radians, grams and tonnes) affect the condition of K, not this number.
  double scaled_condition;
  /// Numbers of positive, negative and zero eigenvalues of K: the numbers of velocity coordinates, of independent
  /// contact rows, and of dependent contact rows. A factor with other signs of pivots is not accepted.
  int positive = 0, negative = 0, zero = 0;
};

struct Report {  // Status and accuracy of the solution of the whole scene.
  Status status = Status::kOk;
  Method method = Method::kAuto;      // the method that was requested
  std::vector<IslandReport> islands;  // one entry per island; with dense-schur one entry, as dense-schur solves the
                                      // scene as one system

  // Sums and maxima over the islands.
  int nv = 0, nc = 0, rank = 0, factor_nonzeros = 0, refinement_steps = 0;
  double residual_dynamics = 0, residual_contact = 0, backward_error = 0;
  double condition = kNotEstimated, error_acceleration = kNotEstimated, error_forces = kNotEstimated;

  SolveTimes times;

  /// Returns whether a and f are a solution: the status is kInconsistent (the least-squares solution) or better.
  bool ok() const { return status <= Status::kInconsistent; }
};

/// Computes all other members of the report, except `method` and `times`, from report.islands.
void summarise(Report& report);

}  // namespace manycontact
