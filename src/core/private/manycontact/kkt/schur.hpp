#pragma once
// The Schur complement S = J M^-1 J^T + delta I of one island, sparse, by the tree-sparse factor M = L^T D L of each
// robot. Source: Featherstone (2008), 6.5 (LTDL).

#include <span>
#include <vector>

#include "manycontact/kkt/pattern.hpp"

namespace manycontact {

/// Constant: which contacts meet on which robot, and where their products go in S.
struct SchurPattern {
  struct OnRobot {
    std::vector<int> contacts;   // contacts of the island that act on the robot
    std::vector<int> first_row;  // first row of each among the rows on the robot
    int rows = 0;
  };
  std::vector<OnRobot> robots;
  std::vector<int> J_first;  // one entry per contact: where its J begins among all contacts', by columns
  sparse::UpperCsc S;        // nc x nc
  std::vector<int> slot;     // S's slots of the upper triangle of each robot's product, by columns, robot after robot
};
/// Counts that analyze_schur would find.
struct SchurCounts {
  std::vector<int> rows;  // one entry per robot: rows that act on it
  double nonzeros = 0;    // nonzeros of S
};
SchurCounts count_schur(const Scene& scene, const Island& island, const IslandSupport& support);
SchurPattern analyze_schur(const Scene& scene, const Island& island, const IslandSupport& support);

/// Numbers. L: per robot, packed; Z: per robot, D^-1/2 L^-T J^T (nv x rows); Sx: S's values.
struct SchurData {
  std::vector<std::vector<double>> L;
  std::vector<Eigen::MatrixXd> Z;
  std::vector<double> Sx, scratch;
  Eigen::VectorXd w, y;  // scratch of solves: nv, nc
};

/// Fills L, Z, Sx. M: the robots' packed inertias, one after the other; J: the contacts' J by columns. False
/// when an inertia is not positive definite.
[[nodiscard]] bool form_schur(const Scene& scene, const Island& island, const IslandSupport& support,
                              const SchurPattern& pattern, std::span<const double> M, std::span<const double> J,
                              double delta, SchurData& data);

}  // namespace manycontact
