#pragma once
// Redundant contact rows of a body-space system: those that move nothing, such as the tension along a straight chain on
// a wall; those on one body that others on it span; and those that constrain a body which others already constrain
// through its joints, as along a straight chain fixed at both ends. They are dropped, and forces of least norm are
// found as in rank/dependent_rows.hpp:
//
//   [a; y] = (I - P) K_kept^-1 (I - P) [b1; b2]
//
// Rows with both ends on bodies that move are not checked: where these are redundant, another system has to solve.

#include "manycontact/kkt/bodies/factor.hpp"
#include "manycontact/rank/dependent_rows.hpp"

namespace manycontact {

/// The rows that depend on others, and how. Storage is kept: solves of one pattern and dependences allocate nothing.
struct BodyDependence {
  rank::DependentRows rows;        // rows by their numbers
  Eigen::VectorXd null_component;  // nc: their inconsistency

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

/// Whether a row moves no coordinate by more than rounding errors. Its pivot then has no correct digit, and no terms
/// that cancel. Always false for damped rows.
bool has_vanishing_row(const BodySystem& system, BodyDependence& work);
/// All rows take part again, in factors to come.
void forget_dropped(BodyLdl& ldl);

/// The factor without the rows that depend on others. kNone: it is sound, and there are such rows, which work.rows has;
/// kSmallPivot: these are not plainly the ones.
[[nodiscard]] Reason factorize_dependent(const BodySystem& system, BodyLdl& ldl, BodyDependence& work);

/// x of b by it, with y of least norm and the bodies' forces of that. The inconsistency of the rows is taken out of
/// b.rows and left in work.null_component.
sparse::Refinement solve_dependent(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps,
                                   BodyDependence& work);

/// The largest of |J| |a| and of a0 among the rows of K, which their inconsistency is judged relative to: gravity,
/// which the bodies' accelerations contain, is in neither. For two bodies that one joint moves, |J| |a| counts it for
/// both. v: solved; overwrites v.dx.
std::pair<double, double> row_terms_of_joints(const BodySystem& system, BodySolve& v);

}  // namespace manycontact
