#pragma once
// Measures how reliable a rank decision was, and the effect of nearly dependent rows. Example: the file of a planar
// loop rounds pi/2 to 1.5708. A row that is redundant in the plane then keeps 4e-6 of its norm, is accepted as
// independent, and blocks the mechanism with forces of thousands of times the loads.

#include <string>
#include <vector>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// A row is nearly dependent if its component orthogonal to the preceding rows is less than this share of its norm, but
/// more than rounding error. Rows that Scene::tolerance makes dependent are not nearly dependent.
constexpr double kOnlyJust = 1e-3;
/// The rank decision is unreliable if the least accepted residual is below this multiple of the largest rejected one.
constexpr double kCloseGap = 1e3;

struct RankGap {          // How reliable the rank decision of an island was.
  bool known = false;     // false: damping decides, or the island failed, is too large, or has no rows
  double least_kept = 1;  // smallest relative residual of an accepted row: the norm of its component
                          // orthogonal to the rows accepted before it, divided by its norm
  double most_dropped = 0;      // largest relative residual of a rejected row; at least eps, the rounding error
  int kept = -1, dropped = -1;  // these rows, as indices of f; -1: there is none

  /// The ratio of the smallest accepted to the largest rejected residual.
  double gap() const { return least_kept / most_dropped; }
};
/// Computes the gap of an island after a solve, with dense matrices. The result is unknown if nv nc^2 exceeds 1e9.
/// Throws std::logic_error before a solve.
RankGap rank_gap(const Scene& scene, const SceneData& data, std::size_t island);
/// Computes the gaps of all islands.
std::vector<RankGap> rank_gaps(const Scene& scene, const SceneData& data);

struct NearDependent {  // Nearly dependent rows of an island, and the solution without them.
  std::size_t island = 0;
  std::vector<int> rows;  // indices of f, ascending
  double left = 0;        // smallest relative residual of these rows
  double times = 0;       // ratio of the island's largest force to its loads: torques, and the forces of the
                          // solution without these rows; infinite without loads
  int coordinate = -1;    // the coordinate of v whose acceleration changes most without the rows
  double acceleration = 0, without = 0;  // acceleration of this coordinate with and without the rows [m/s^2, rad/s^2]
};
/// Lists islands with nearly dependent rows after a solve at q (nq), at the cost of a solve of the scene at rest each.
/// Throws std::logic_error before a solve.
std::vector<NearDependent> near_dependent(const Scene& scene, const ConstVectorRef& q, const SceneData& data);
/// Describes the effect: "the other rows leave 4e-06 of it, forces are 1e+05 times the loads; without, r/knee would
/// accelerate by 3 instead of 0". The rows are named by the entries `rows` of force_names(scene, data).
std::string in_words(const Scene& scene, const NearDependent& found);

}  // namespace manycontact
