#pragma once
// The pattern of an island's KKT matrix, K = [M J^T; J -delta I], in an order of elimination.

#include <memory>
#include <mutex>
#include <vector>

#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/kkt/options.hpp"
#include "manycontact/sparse/ldl_schedule.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

/// Places of the active contact rows, which K's pattern depends on, in addition to the trees.
struct IslandSupport {
  std::vector<ContactSupport> contacts;   // one entry per contact of the island, numbered within the robots
  std::vector<std::vector<int>> columns;  // one entry per contact: the island's columns, a's first, then b's
};
IslandSupport island_support(const Scene& scene, const Island& island);

/// A schedule made when first asked for, by whichever thread.
struct LazySchedule {
  std::mutex mutex;
  std::unique_ptr<const sparse::LdlSchedule> schedule;
};

/// Pattern of P K P^T, place of every number, and symbolic factorization. Constant; shared by islands of one shape.
struct KktPattern {
  int nv = 0, nc = 0;
  Order order = Order::kLeafToRoot;
  std::vector<int> perm, iperm;    // perm[k]: row of K eliminated k-th; iperm its inverse
  std::vector<char> of_M;          // flags of K's rows, in that order: it is one of M's
  sparse::UpperCsc K;              // pattern of P K P^T
  std::vector<int> M_slot;         // slot of each entry of the robots' packed M, robot after robot
  std::vector<int> J_slot;         // slot of each entry of the contacts' J, by columns, contact after contact
  std::vector<int> diagonal_slot;  // slot of each contact row's diagonal
  sparse::LdlSymbolic ldl;
  std::shared_ptr<LazySchedule> lazy_schedule = std::make_shared<LazySchedule>();  // made and kept by schedule()

  /// The numeric LDL, compiled when first asked for and kept.
  const sparse::LdlSchedule& schedule() const;
  int size() const { return nv + nc; }
};

/// K's pattern, joints and contact rows numbered as the island has them.
sparse::UpperCsc natural_pattern(const Scene& scene, const Island& island, const IslandSupport& support);

// The orders in which rows of K are eliminated: permutations, as KktPattern::perm. K: natural_pattern.

/// Whether each of the island's robots has a neighbour, through a contact, and none is further from the ground, counted
/// in contacts; false for all where no contact is with the ground. In a tower that is the free end.
std::vector<char> robots_furthest_from_ground(const Scene& scene, const Island& island);
/// CAMD's order of n rows with these entries (row, column). Row n comes last, and is left out: rows that share it with
/// the robots furthest from the ground come late.
std::vector<int> camd_order_from_ground(int n, std::vector<std::pair<int, int>> entries);

/// Order::kCamd. Where it makes no other difference, contacts on the robots furthest from the ground come late.
std::vector<int> camd_order(const Scene& scene, const Island& island, const sparse::UpperCsc& K);
/// Order::kLeafToRoot. by_degree: camd_order's, whose order the contact rows have among themselves.
std::vector<int> leaf_to_root_order(const Scene& scene, const Island& island, const std::vector<int>& by_degree);
/// Order::kContactsEarly. It looks at the contacts' J in a configuration without symmetry, so it depends on the
/// contacts' types, axes and places on A's bodies, as well as on the trees. Robots go in the island's order, or by CAMD
/// on the graph of those that contacts join, hubs last, where that makes the factor clearly cheaper.
std::vector<int> contacts_early_order(const Scene& scene, const Island& island, const IslandSupport& support,
                                      const sparse::UpperCsc& K);

/// perm: one of these. K: natural_pattern.
KktPattern analyze(const Scene& scene, const Island& island, const IslandSupport& support, const sparse::UpperCsc& K,
                   Order order, std::vector<int> perm);

// Islands with many times more contact rows than coordinates: a thousand points on one sole. Nearly all rows depend on
// the others, and among rows of one body a sparse factor is full: its cost is cubic in the contacts, that of the dense
// method, which decomposes J of few columns, is linear.

/// Whether kAuto chooses the dense method.
inline bool overdetermined(const Island& island) {
  return island.nc >= tolerance::kOverdetermined && island.nc > tolerance::kTimesOverdetermined * island.nv;
}

/// Whether the sparse methods with an order are replaced by the dense method, too. Their factors would need too much
/// memory and are not analysed.
inline bool too_full_for_sparse(const Island& island) {
  return island.nc >= tolerance::kTooFull && overdetermined(island);
}

}  // namespace manycontact
