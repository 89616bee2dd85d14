#pragma once
// An island is divided into robots and the interface rows, those of contacts that couple two robots. With these rows
// last, K is
//
//     [ K_1             G_1^T    ]
//     [      ...        ...      ]    K_r = [ M_r J_r^T; J_r -delta I ]: a robot and the contacts on it alone,
//     [           K_n   G_n^T    ]    G_r: the interface rows' entries at its velocities,
//     [ G_1  ...  G_n   -delta I ]
//
// and the robots' elimination leaves -S = -sum_r G_r K_r^-1 G_r^T - delta I on the interface rows. These are few, and
// two of them are coupled only through a robot on which both act.

#include <vector>

#include "manycontact/kkt/shape.hpp"
#include "manycontact/sparse/ldl_schedule.hpp"

namespace manycontact {

/// Interface rows of islands of one shape; constant.
struct Interface {
  explicit Interface(const IslandShape& shape);

  struct OfRobot {
    std::vector<int> contacts;        // contacts of the island on this robot alone
    std::vector<int> joins;           // and those that join it to another
    std::vector<int> neighbours;      // robots of the island at their other ends
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

/// Least counts of S's factor, in any order and without S: any two rows of a robot meet there.
sparse::LdlCounts least_interface_counts(const IslandShape& shape);

inline bool joins_two(const Contact& contact) { return joins_robots(contact) && contact.A.robot != contact.B.robot; }
/// The end of a joining contact that is on this robot.
inline const Attachment& end_on(const Contact& contact, int robot) {
  return contact.A.robot == robot ? contact.A : contact.B;
}

}  // namespace manycontact
