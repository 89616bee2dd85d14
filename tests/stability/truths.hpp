#pragma once
// The right solution of a problem in quadruple precision, and the scales of its errors.

#include <vector>

#include "manycontact/dynamics/report.hpp"
#include "stability/condition.hpp"

namespace manycontact::test {

/// Returns the larger number, or NaN if either is.
inline double worse(double a, double b) { return b <= a ? a : a != a ? a : b; }

/// Known properties of one island.
struct IslandTruth {
  std::vector<int> v, f;       // its coordinates in a, its rows in f
  bool regular = false;        // there is a solution
  Condition condition;         // condition of K
  Condition damped_condition;  // if a damping is reported as lost: condition of K with it
};

/// A robot, and the contacts that it is part of.
struct RobotPlaces {
  std::vector<int> v, f;  // coordinates in a, rows in f
  int island = 0;
};

/// Changes of a and f along a random direction in q (on the tangent space), in v or in u.
struct Direction {
  VecX<Quad> dq, dv, du;  // two of them empty
  VecX<Quad> da, df;
};

struct Truths {
  explicit Truths(const Problem& p);

  bool exists = false;  // all islands regular, all numbers finite
  VecX<Quad> a, f;
  std::vector<IslandTruth> islands;   // in the order of find_islands
  std::vector<RobotPlaces> robots;    // of the scene
  std::vector<Direction> directions;  // one of each kind; none where no derivatives are known (derivatives.hpp)
  int rank = 0, rows = 0;             // rank and rows of J, over all islands
  // least residual of J a + a0, relative to its terms, and to gravity or its terms; -1: the problem is too large
  double contradiction = -1, contradiction_over_gravity = -1;
  Eigen::VectorXd a_free;  // where a or v vanishes: accelerations without contacts, the scale of errors; else empty
  Eigen::VectorXd tau_b;   // S^T u - h
  double J_size = 0;       // largest entry of J
};

/// Returns the report on an island: that of dense-schur is a single one on all of them.
const IslandReport& report_of(const Report& report, std::size_t island);

/// Returns the condition of the reported K, to which the island's errors are relative.
double condition_of(const Truths& truths, const Report& report, std::size_t island);

/// Returns the truth that a solution claims: without damping for islands that were regularised because their damping is
/// lost in rounding, the given truth for the others.
Truths claimed(const Truths& damped, const Truths& undamped, const Report& report);

Problem without_damping(Problem p);

}  // namespace manycontact::test
