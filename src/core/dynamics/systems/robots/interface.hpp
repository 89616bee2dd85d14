#pragma once
// An island as robots and interface rows, i.e. the rows of contacts that couple two robots. With these rows last, K is
//
//     [ K_1             G_1^T    ]
//     [      ...        ...      ]    K_r = [ M_r J_r^T; J_r -delta I ]: a robot and the contacts on it alone,
//     [           K_n   G_n^T    ]    G_r: the interface rows' entries at its velocities,
//     [ G_1  ...  G_n   -delta I ]
//
// and eliminating the robots leaves -S = -sum_r G_r K_r^-1 G_r^T - delta I in the interface rows. These are few, and
// two of them are coupled only if both act on a common robot.

#include <vector>

#include "manycontact/kkt/shape.hpp"
#include "manycontact/sparse/ldl_schedule.hpp"

namespace manycontact {

/// Interface rows of islands of one shape; constant.
struct Interface {
  explicit Interface(const IslandShape& shape);

  struct OfRobot {
    std::vector<int> contacts;        // contacts of the island on this robot alone
    std::vector<int> joins;           // contacts that couple it to another
    std::vector<int> neighbours;      // robots of the island at the other ends of `joins`
    std::vector<int> interface_rows;  // one entry per row of G_r: the interface row
    std::vector<int> slot;            // slots in S of the upper triangle of G_r K_r^-1 G_r^T, by columns
  };
  std::vector<OfRobot> robots;
  std::vector<int> row;          // one entry per interface row: the island's row
  std::vector<int> perm, place;  // perm[k]: interface row eliminated k-th from S; place its inverse
  sparse::UpperCsc S;            // pattern of S, in that order
  double flops = 0;              // multiply-adds of its factor
  sparse::LdlSchedule schedule;

  int rows() const { return static_cast<int>(row.size()); }
};

/// Returns lower bounds of the counts of S's factor in any order, without S: all rows of a robot are coupled.
sparse::LdlCounts least_interface_counts(const IslandShape& shape);

inline bool joins_two(const Contact& contact) { return joins_robots(contact) && contact.A.robot != contact.B.robot; }
/// Returns the end of a coupling contact on this robot.
inline const Attachment& end_on(const Contact& contact, int robot) {
  return contact.A.robot == robot ? contact.A : contact.B;
}

}  // namespace manycontact
