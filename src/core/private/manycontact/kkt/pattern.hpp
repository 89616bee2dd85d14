#pragma once
// Pattern of an island's KKT matrix K = [M J^T; J -delta I] in an elimination order.

#include <memory>
#include <mutex>
#include <vector>

#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/kkt/options.hpp"
#include "manycontact/sparse/ldl_schedule.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

/// Columns of the active contact rows, on which K's pattern depends in addition to the trees.
struct IslandSupport {
  std::vector<ContactSupport> contacts;   // one entry per contact of the island, numbered within the robots
  std::vector<std::vector<int>> columns;  // one entry per contact: the island's columns, a's first, then b's
};
IslandSupport island_support(const Scene& scene, const Island& island);

/// A schedule compiled when first needed, by any thread.
struct LazySchedule {
  std::mutex mutex;
  std::unique_ptr<const sparse::LdlSchedule> schedule;
};

/// Pattern of P K P^T, slots of all entries, and symbolic factorization. Constant; shared by islands of one shape.
struct KktPattern {
  int nv = 0, nc = 0;
  Order order = Order::kLeafToRoot;
  std::vector<int> perm, iperm;    // perm[k]: row of K eliminated k-th; iperm its inverse
  std::vector<char> of_M;          // whether each row of K, in that order, is a row of M
  sparse::UpperCsc K;              // pattern of P K P^T
  std::vector<int> M_slot;         // slot of each entry of the robots' packed M, robot after robot
  std::vector<int> J_slot;         // slot of each entry of the contacts' J, by columns, contact after contact
  std::vector<int> diagonal_slot;  // slot of each contact row's diagonal
  sparse::LdlSymbolic ldl;
  std::shared_ptr<LazySchedule> lazy_schedule = std::make_shared<LazySchedule>();  // used by schedule()

  /// Returns the numeric LDL's schedule; compiled at the first call.
  const sparse::LdlSchedule& schedule() const;
  int size() const { return nv + nc; }
};

/// Returns K's pattern in the island's numbering.
sparse::UpperCsc natural_pattern(const Scene& scene, const Island& island, const IslandSupport& support);

// Elimination orders: permutations as KktPattern::perm. K: natural_pattern.

/// Whether each robot has a neighbour through a contact, and none is further from the ground, counted in contacts;
/// false for all without contacts to the ground. In a tower this is the free end.
std::vector<char> robots_furthest_from_ground(const Scene& scene, const Island& island);
/// Returns CAMD's order of n rows with these entries. Row n is last and removed; rows coupled with it come late.
std::vector<int> camd_order_from_ground(int n, std::vector<std::pair<int, int>> entries);

/// Returns Order::kCamd. Ties are broken so that contacts on the robots furthest from the ground come late.
std::vector<int> camd_order(const Scene& scene, const Island& island, const sparse::UpperCsc& K);
/// Returns Order::kLeafToRoot. by_degree: camd_order, which orders the contact rows among themselves.
std::vector<int> leaf_to_root_order(const Scene& scene, const Island& island, const std::vector<int>& by_degree);
/// Returns Order::kContactsEarly. It evaluates J in a configuration without symmetry, so it depends on types, axes and
/// placements on A. Robots are in the island's order or, if clearly cheaper, in CAMD's of the graph of coupled robots.
std::vector<int> contacts_early_order(const Scene& scene, const Island& island, const IslandSupport& support,
                                      const sparse::UpperCsc& K);

/// Analyses K in one of these orders `perm`. K: natural_pattern.
KktPattern analyze(const Scene& scene, const Island& island, const IslandSupport& support, const sparse::UpperCsc& K,
                   Order order, std::vector<int> perm);

// Islands with many more contact rows than coordinates, e.g. a thousand points on one sole. Nearly all rows are
// redundant, and a sparse factor is full: its cost is cubic in the contacts, that of the dense method linear.

/// Whether kAuto chooses the dense method.
inline bool overdetermined(const Island& island) {
  return island.nc >= tolerance::kOverdetermined && island.nc > tolerance::kTimesOverdetermined * island.nv;
}

/// Whether the dense method also replaces sparse methods with an order, whose factors would need too much memory.
inline bool too_full_for_sparse(const Island& island) {
  return island.nc >= tolerance::kTooFull && overdetermined(island);
}

}  // namespace manycontact
