#pragma once
// Measures how reliable a rank decision was, and the effect of nearly dependent rows. Example: the file of a planar
// loop rounds pi/2 to 1.5708. A row that would be redundant in the plane then has a component of 4e-6 of its norm
// orthogonal to the other rows. It is accepted, and blocks the mechanism with forces of thousands of times the loads.

#include <string>
#include <vector>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// A row is nearly dependent if its component orthogonal to the preceding rows is less than this share of its norm, but
/// more than a rounding error. Rows that Scene::tolerance makes dependent are not nearly dependent.
constexpr double kOnlyJust = 1e-3;
/// The rank decision is unreliable if the least accepted residual is below this multiple of the largest rejected one.
constexpr double kCloseGap = 1e3;

struct RankGap {                // How reliable the rank decision of an island was.
  bool known = false;           // false: damping decides, or the island failed, is too large, or has no rows
  double least_kept = 1;        // smallest relative residual of an accepted row: the norm of its component
                                // orthogonal to the rows accepted before it, divided by its norm
  double most_dropped = 0;      // largest relative residual of a rejected row; at least eps, the rounding error
  int kept = -1, dropped = -1;  // rows with these two residuals, as indices of f; -1: there is no such row

  /// Returns the ratio of the smallest accepted to the largest rejected residual.
  double gap() const { return least_kept / most_dropped; }
};
/// Computes the gap of an island of nv velocities and nc rows after a solve, with dense matrices. The result is unknown
/// if nv nc^2 exceeds 1e9. Throws std::logic_error before a solve.
RankGap rank_gap(const Scene& scene, const SceneData& data, std::size_t island);
/// Returns rank_gap of every island.
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
/// Lists islands with nearly dependent rows after a solve at q (nq). Each such island costs another solve of the scene
/// at rest. Throws std::logic_error before a solve.
std::vector<NearDependent> near_dependent(const Scene& scene, const ConstVectorRef& q, const SceneData& data);
/// Describes the effect of the rows: "the other rows leave 4e-06 of it, forces are 1e+05 times the loads; without,
/// r/knee would accelerate by 3 instead of 0". A row's name is its entry of force_names(scene, data).
std::string in_words(const Scene& scene, const NearDependent& found);

}  // namespace manycontact
