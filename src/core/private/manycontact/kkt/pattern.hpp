#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/kkt/options.hpp"
#include "manycontact/sparse/ldl_schedule.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

struct IslandSupport {
  std::vector<ContactSupport> contacts;   // one entry per contact of the island; coordinates numbered within the robots
  std::vector<std::vector<int>> columns;  // one entry per contact: the island's coordinates that move A, then B'
};
IslandSupport island_support(const Scene& scene, const Island& island);

struct LazySchedule {  // compiled by the first thread that needs it
  std::mutex mutex;
  std::unique_ptr<const sparse::LdlSchedule> schedule;
};

/// The constant pattern of P K P^T, P the permutation to elimination order, with slots of M and J, and its analysis.
struct KktPattern {
  int nv = 0, nc = 0;
  Order order = Order::kLeafToRoot;
  std::vector<int> perm, iperm;    // perm[k]: row of K that is eliminated k-th; iperm: the inverse
  std::vector<char> of_M;          // one flag per row of P K P^T: it is a row of M
  sparse::UpperCsc K;              // pattern of P K P^T
  std::vector<int> M_slot;         // slot in K of each entry of the robots' packed M, robot after robot
  std::vector<int> J_slot;         // slot in K of each entry of the contacts' J, by columns, contact after contact
  std::vector<int> diagonal_slot;  // slot in K of the diagonal entry of each contact row
  sparse::LdlSymbolic ldl;
  std::shared_ptr<LazySchedule> lazy_schedule = std::make_shared<LazySchedule>();  // used by schedule()

  const sparse::LdlSchedule& schedule() const;  // the first call compiles it
  int size() const { return nv + nc; }
};

/// Returns K's pattern with coordinates and rows in the island's numbering.
sparse::UpperCsc natural_pattern(const Scene& scene, const Island& island, const IslandSupport& support);

// Functions that compute elimination orders, as permutations KktPattern::perm. K is the result of natural_pattern.

/// Returns one flag per robot: contacts couple it to other robots, none of which is further from the ground. Distances
/// are numbers of contacts. In a tower this is the robot at the free end. All flags are false without contacts to the
/// ground.
std::vector<char> robots_furthest_from_ground(const Scene& scene, const Island& island);
/// Returns CAMD's order of rows 0 ... n-1. Row n comes last and is not returned; rows with entries in it come late.
std::vector<int> camd_order_from_ground(int n, std::vector<std::pair<int, int>> entries);

/// Returns the order kCamd; among equivalent orders, contacts on the robots furthest from the ground come late.
std::vector<int> camd_order(const Scene& scene, const Island& island, const sparse::UpperCsc& K);
/// Returns the order kLeafToRoot. by_degree: the result of camd_order, from which the order of contact rows is taken.
std::vector<int> leaf_to_root_order(const Scene& scene, const Island& island, const std::vector<int>& by_degree);
/// Returns the order kContactsEarly, from J in configurations without symmetry: it depends on contacts' types, axes and
/// placements on A. Robots are in the island's order or, if clearly cheaper, in CAMD's of the coupled robots.
std::vector<int> contacts_early_order(const Scene& scene, const Island& island, const IslandSupport& support,
                                      const sparse::UpperCsc& K);

/// Returns the pattern and symbolic factorization of K in the order `perm`, one of those above. K: natural_pattern.
KktPattern analyze(const Scene& scene, const Island& island, const IslandSupport& support, const sparse::UpperCsc& K,
                   Order order, std::vector<int> perm);

// Overdetermined islands have far more contact rows than coordinates, e.g. a thousand points on one sole. A sparse
// factor is full: its cost is cubic in the contacts, that of the dense method linear.

inline bool overdetermined(const Island& island) {  // kAuto is then dense
  return island.nc >= tolerance::kOverdetermined && island.nc > tolerance::kTimesOverdetermined * island.nv;
}

/// Whether the dense method replaces sparse methods that have an order, as their factors would need too much memory.
inline bool too_full_for_sparse(const Island& island) {
  return island.nc >= tolerance::kTooFull && overdetermined(island);
}

}  // namespace manycontact
