#pragma once
// Redundant contact rows of a body-space system, of three kinds: rows that move nothing, e.g. along a straight chain
// fixed at one end; rows spanned by other rows on the same body; and rows on a body that is constrained through its
// joints already, e.g. along a straight chain fixed at both ends. They are dropped, and forces are of least norm:
//
//   [a; y] = (I - P) K_kept^-1 (I - P) [b1; b2]      P: the projector of rank/dependent_rows.hpp
//
// Rows with both ends on moving bodies are not checked: if such rows are redundant, another system must solve.

#include "manycontact/kkt/bodies/factor.hpp"
#include "manycontact/rank/dependent_rows.hpp"

namespace manycontact {

/// The dependent rows and their null space. Memory is reused for the same pattern and null space.
struct BodyDependence {
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

/// Whether an undamped row moves no coordinate by more than rounding errors, so that its pivot has no correct digit.
bool has_vanishing_row(const BodySystem& system, BodyDependence& work);
/// Clears the list of dropped rows, so that later factors include them.
void forget_dropped(BodyLdl& ldl);

/// Factorizes without dependent rows. kNone: sound, dropped rows in work.rows; kSmallPivot: the rank is uncertain.
[[nodiscard]] Reason factorize_dependent(const BodySystem& system, BodyLdl& ldl, BodyDependence& work);

/// Solves for x with y of least norm; moves the inconsistency of the rows from b.rows to work.null_component.
sparse::Refinement solve_dependent(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps,
                                   BodyDependence& work);

/// Returns the largest |J| |a| and the largest a0 of a row, without gravity, relative to which inconsistency is judged.
/// If one joint moves both bodies of a row, |J| |a| counts it twice. v: the solution; overwrites v.dx.
std::pair<double, double> row_terms_of_joints(const BodySystem& system, BodySolve& v);

}  // namespace manycontact
