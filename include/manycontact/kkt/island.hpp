#pragma once
// Islands: robots joined by active contacts between bodies. Each has a KKT system of its own; the world joins nothing.

#include <vector>

#include "manycontact/contact/rows.hpp"

namespace manycontact {

struct Island {
  std::vector<int> robots;      // scene numbers, ascending
  std::vector<int> contacts;    // scene numbers of the active ones, ascending
  std::vector<int> dof_offset;  // per robot: its first coordinate in the island
  std::vector<int> row_offset;  // per contact: its first row in the island
  int nv = 0, nc = 0;

  int size() const { return nv + nc; }
};

/// The islands of the scene with the given contacts active (one flag each), in the order of their first robots.
std::vector<Island> find_islands(const Scene& scene, const std::vector<char>& active);

/// Position of a robot in island.robots.
int local_robot(const Island& island, int robot);

}  // namespace manycontact
