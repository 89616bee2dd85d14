#pragma once
// How near the decision was which contact rows depend on each other, and what rows that only just count cost. A loop
// whose file rounds pi/2 to 1.5708 is no plane mechanism: a row that says nothing in the plane keeps 4e-6 of its
// length, counts, and holds still what should move, by forces of thousands of times the loads.

#include <vector>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Of a row's size: rows of which the ones before leave less, but more than rounding, only just count.
constexpr double kOnlyJust = 1e-3;
/// Least row kept beside largest row dropped: below this the one could as well be the other.
constexpr double kCloseGap = 1e3;

struct RankGap {       // Of an island.
  bool known = false;  // false: damping decides, the island failed, is too large or has no rows
  double least_kept =
      1;  // what rows before it leave of the row kept that has least, of its size (contact/row_scale.hpp)
  double most_dropped = 0;  // and of the row dropped that has most; at least eps, which is what rounding leaves of rows
  int kept = -1, dropped = -1;  // these rows, of f; -1: there is none

  /// Least kept beside most dropped.
  double gap() const { return least_kept / most_dropped; }
};
/// After a solve. Dense, left out where nv nc^2 is above 1e9.
RankGap rank_gap(const Scene& scene, const SceneData& data, std::size_t island);
/// The same of every island.
std::vector<RankGap> rank_gaps(const Scene& scene, const SceneData& data);

struct NearDependent {  // Rows of an island that only just count, and what would be without them.
  std::size_t island = 0;
  std::vector<int> rows;  // of f, ascending
  double left = 0;        // what is left of the least of them, of its size
  double times = 0;       // the island's largest force beside its loads: torques, and the forces there would be
                          // without these rows; infinite where there are none
  int coordinate = -1;    // of v, whose acceleration changes most without them ...
  double acceleration = 0, without = 0;  // ... from, to [m/s^2, rad/s^2]
};
/// After a solve at q (nq): islands with rows that only just count. A solve of the scene at rest for each of these.
/// Throws std::logic_error before a solve.
std::vector<NearDependent> near_dependent(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                                          const SceneData& data);

}  // namespace manycontact
