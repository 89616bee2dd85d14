#pragma once
// The right answer of a problem in quadruple precision, and what its errors are measured by.

#include <vector>

#include "manycontact/dynamics/report.hpp"
#include "stability/condition.hpp"

namespace manycontact::test {

/// The larger one, or what is no number.
inline double worse(double a, double b) { return b <= a ? a : a != a ? a : b; }

/// What is known of one island.
struct IslandTruth {
  std::vector<int> v, f;       // its coordinates in a, its rows in f
  bool regular = false;        // there is an answer to give
  Condition condition;         // of K
  Condition damped_condition;  // where a damping is claimed to be lost: of K with it
};

/// A robot, and the contacts that it is part of.
struct RobotPlaces {
  std::vector<int> v, f;  // coordinates in a, rows in f
  int island = 0;
};

/// What a and f change by along a random direction in q (on the tangent space), in v or in u.
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
  int rank = 0, rows = 0;             // of J, over all islands
  // of J a + a0 that no acceleration can avoid: relative to its terms, and to gravity or its terms; -1: too large to
  // see
  double contradiction = -1, contradiction_over_gravity = -1;
  Eigen::VectorXd a_free;  // where a or v vanishes: accelerations without contacts, the scale of errors; else empty
  Eigen::VectorXd tau_b;   // S^T u - h
  double J_size = 0;       // largest entry
};

/// The report on an island: that of dense-schur is a single one on all of them.
const IslandReport& report_of(const Report& report, std::size_t island);

/// What the island's errors are judged by: the condition of the K that the report is on.
double condition_of(const Truths& truths, const Report& report, std::size_t island);

/// What an answer claims to be: of islands that were regularised, because their damping is lost in rounding, the truth
/// without damping; of the others the truth.
Truths claimed(const Truths& damped, const Truths& undamped, const Report& report);

/// The same problem without damping.
Problem without_damping(Problem p);

}  // namespace manycontact::test
