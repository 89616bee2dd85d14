#pragma once
// Redundant contact rows of a body-space system are dropped: rows whose forces drive no joint (e.g. a straight chain
// fixed at one end), rows spanned by others on their body, and rows on a body that its joints and other rows constrain
// already (e.g. a straight chain fixed at both ends). The forces have least norm:
//
//   [a; y] = (I - P) K_kept^-1 (I - P) [b1; b2]      P: the projector of rank/dependent_rows.hpp
//
// Only rows with an immovable end are dropped. If other rows are redundant, the island must be solved by a factor of K.

#include "manycontact/kkt/bodies/factor.hpp"
#include "manycontact/rank/dependent_rows.hpp"

namespace manycontact {

struct BodyDependence {            // allocates nothing for the same pattern and null space as before
  rank::DependentRows rows;        // null space; rows are numbered as the system's rows
  Eigen::VectorXd null_component;  // nc: part of b.rows in the null space, the inconsistency

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
  std::vector<int> dropped_at, column, entries;  // dropped_at, column: one entry per row
  std::vector<double> x;                         // one entry per row
};

/// Whether damping is zero, and some row of J has only rounding errors as entries, so that its pivot has no digit.
bool has_vanishing_row(const BodySystem& system, BodyDependence& work);
void forget_dropped(BodyLdl& ldl);  // later factors include the dropped rows

/// Factorizes the system without dependent rows. Returns kNone if the factor is sound and work.rows has the dropped
/// rows, kSmallPivot if no row is dependent or if the rank is uncertain, or another reason of factorize_bodies.
[[nodiscard]] Reason factorize_dependent(const BodySystem& system, BodyLdl& ldl, BodyDependence& work);

/// Solves for v.x with y of least norm. Moves the inconsistency of the rows from v.b.rows to work.null_component.
sparse::Refinement solve_dependent(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps,
                                   BodyDependence& work);

/// Returns the largest |J| |qdd| and the largest |a0| of a row, both without gravity, relative to which inconsistency
/// is judged. If one joint moves both bodies of a row, |J| |qdd| counts it twice. v.x: the solution. Overwrites v.dx.
std::pair<double, double> row_terms_of_joints(const BodySystem& system, BodySolve& v);

}  // namespace manycontact
