#pragma once
// Redundant contact rows of a body-space system: rows that move nothing, e.g. along a straight chain fixed at one end;
// rows spanned by others on the same body; and rows on a body already constrained through its joints, e.g. along a
// straight chain fixed at both ends. They are dropped, with least-norm forces as in rank/dependent_rows.hpp:
//
//   [a; y] = (I - P) K_kept^-1 (I - P) [b1; b2]
//
// Rows with both ends on moving bodies are not checked: if these are redundant, another system must solve.

#include "manycontact/kkt/bodies/factor.hpp"
#include "manycontact/rank/dependent_rows.hpp"

namespace manycontact {

/// The dependent rows and their dependences. Memory is reused for the same pattern and dependences.
struct BodyDependence {
  rank::DependentRows rows;        // numbered as the system's rows
  Eigen::VectorXd null_component;  // nc: inconsistency of the dependent rows

  // scratch
  struct Basis {
    Mat6<double> Q;
    int rank = 0;
  };
  struct OnBody {
    int row;
    Vec6<double> F;
    double length;
  };
  std::vector<Basis> bases;  // one entry per node
  std::vector<OnBody> on_body;
  std::vector<int> dropped_at, column, entries;  // the first two per row
  std::vector<double> x;                         // one entry per row
};

/// Whether an undamped row moves no coordinate by more than rounding, so that its pivot has no correct digit.
bool has_vanishing_row(const BodySystem& system, BodyDependence& work);
/// Includes all rows again in later factors.
void forget_dropped(BodyLdl& ldl);

/// Factorizes without the dependent rows. kNone: sound, rows in work.rows; kSmallPivot: they are not certain.
[[nodiscard]] Reason factorize_dependent(const BodySystem& system, BodyLdl& ldl, BodyDependence& work);

/// Solves for x, with y of least norm; moves the rows' inconsistency from b.rows to work.null_component.
sparse::Refinement solve_dependent(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps,
                                   BodyDependence& work);

/// Returns the largest of |J| |a| and of a0 among the rows, relative to which inconsistency is judged, both without
/// gravity. For two bodies moved by one joint |J| |a| counts it twice. v: solved; overwrites v.dx.
std::pair<double, double> row_terms_of_joints(const BodySystem& system, BodySolve& v);

}  // namespace manycontact
