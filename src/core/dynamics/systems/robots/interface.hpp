#pragma once
// Splits an island into robots and interface rows (of contacts that couple two robots). With the latter last, K is
//
//     [ K_1             G_1^T    ]
//     [      ...        ...      ]    K_r = [ M_r J_r^T; J_r -delta I ]: a robot and the contacts on it alone,
//     [           K_n   G_n^T    ]    G_r: the interface rows' entries at its velocities,
//     [ G_1  ...  G_n   -delta I ]
//
// Eliminating robots leaves -S = -sum_r G_r K_r^-1 G_r^T - delta I, with entries only between rows of a common robot.

#include <vector>

#include "manycontact/kkt/shape.hpp"
#include "manycontact/sparse/ldl_schedule.hpp"

namespace manycontact {

struct Interface {  // constant data of the interface rows, for islands of one shape
  explicit Interface(const IslandShape& shape);

  struct OfRobot {
    std::vector<int> contacts;        // contacts of the island on this robot alone
    std::vector<int> joins;           // contacts of the island that couple this robot to another
    std::vector<int> neighbours;      // robots of the island at the other ends of `joins`
    std::vector<int> interface_rows;  // one entry per row of G_r: the interface row
    std::vector<int> slot;            // where the upper triangle of G_r K_r^-1 G_r^T, by columns, is added in S
  };
  std::vector<OfRobot> robots;
  std::vector<int> row;          // one entry per interface row: the island's row
  std::vector<int> perm, place;  // perm[k]: the interface row eliminated k-th from S; place: the inverse of perm
  sparse::UpperCsc S;            // pattern of S, in elimination order
  double flops = 0;              // multiply-adds of the factorization of S
  sparse::LdlSchedule schedule;

  int rows() const { return static_cast<int>(row.size()); }
};

/// Returns lower bounds, for any elimination order, of entries and flops of S's factor. S has a full block for the
/// interface rows of each robot.
sparse::LdlCounts least_interface_counts(const IslandShape& shape);

inline bool joins_two(const Contact& contact) { return joins_robots(contact) && contact.A.robot != contact.B.robot; }
inline const Attachment& end_on(const Contact& contact, int robot) {  // end of a coupling contact on this robot
  return contact.A.robot == robot ? contact.A : contact.B;
}

}  // namespace manycontact
