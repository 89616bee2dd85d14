#pragma once
// Contact rows of a body-space system that depend on each other: those that move nothing, as the pull along a straight
// chain that hangs on a wall; those on one body that others on it say; and those that hold a body where another that it
// hangs together with stands already, as along a straight chain held twice. They are dropped, and forces of least norm
// are found as rank/dependent_rows.hpp has it:
//
//   [a; y] = (I - P) K_kept^-1 (I - P) [b1; b2]
//
// Rows with both ends on bodies that move are not looked at: where these depend, another way has to answer.

#include "manycontact/kkt/bodies/factor.hpp"
#include "manycontact/rank/dependent_rows.hpp"

namespace manycontact {

/// Which rows depend, and how. Storage is kept: nothing is allocated for a system of the same pattern and dependences.
struct BodyDependence {
  rank::DependentRows rows;        // by their numbers
  Eigen::VectorXd null_component;  // nc: what they contradict each other by

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
  std::vector<Basis> bases;  // per node
  std::vector<OnBody> on_body;
  std::vector<int> dropped_at, column, entries;  // the first two per row
  std::vector<double> x;                         // per row
};

/// Whether a row moves no coordinate by more than rounding: its pivot is noise, and has nothing to cancel with. Never
/// where rows are damped.
bool has_vanishing_row(const BodySystem& system, BodyDependence& work);
/// All rows take part again, in factors to come.
void forget_dropped(BodyLdl& ldl);

/// The factor without the rows that depend on others. kNone: it is sound, and there are such rows, which work.rows has;
/// kSmallPivot: these are not plainly the ones.
[[nodiscard]] Reason factorize_dependent(const BodySystem& system, BodyLdl& ldl, BodyDependence& work);

/// x of b by it, with y of least norm and the bodies' forces of that. b.rows loses what the rows contradict each other
/// by, which is left in work.null_component.
sparse::Refinement solve_dependent(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps,
                                   BodyDependence& work);

/// Of the rows of K, the largest of |J| |a| and of a0, which what they contradict each other by is judged beside:
/// gravity, which the bodies' accelerations have in them, is in neither. For two bodies that one joint moves, |J| |a|
/// counts it for both. v: solved; overwrites v.dx.
std::pair<double, double> row_terms_of_joints(const BodySystem& system, BodySolve& v);

}  // namespace manycontact
