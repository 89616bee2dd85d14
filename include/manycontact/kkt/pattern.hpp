#pragma once
// The pattern of an island's KKT matrix, K = [M J^T; J -delta I], in an order of elimination.

#include <memory>
#include <mutex>
#include <vector>

#include "manycontact/kkt/island.hpp"
#include "manycontact/kkt/options.hpp"
#include "manycontact/sparse/ldl_schedule.hpp"

namespace manycontact {

/// The active contact rows' places: what K's pattern depends on, besides the trees.
struct IslandSupport {
  std::vector<ContactSupport> contacts;   // per contact of the island, numbered within the robots
  std::vector<std::vector<int>> columns;  // per contact: the same as columns of the island, a's first, then b's
};
IslandSupport island_support(const Scene& scene, const Island& island);

/// A schedule made when first asked for, by whichever thread.
struct LazySchedule {
  std::mutex mutex;
  std::unique_ptr<const sparse::LdlSchedule> schedule;
};

/// Pattern of P K P^T, where every number goes, and the symbolic factorization. Constant; shared by alike islands.
struct KktPattern {
  int nv = 0, nc = 0;
  Order order = Order::kLeafToRoot;
  std::vector<int> perm, iperm;    // perm[k]: row of K eliminated k-th; iperm its inverse
  sparse::UpperCsc K;              // of P K P^T
  std::vector<int> M_slot;         // slot of each entry of the robots' packed M, robot after robot
  std::vector<int> J_slot;         // slot of each entry of the contacts' J, by columns, contact after contact
  std::vector<int> diagonal_slot;  // slot of each contact row's diagonal
  sparse::LdlSymbolic ldl;
  std::shared_ptr<LazySchedule> lazy_schedule = std::make_shared<LazySchedule>();  // for schedule()

  /// The numeric LDL, compiled when first asked for and kept.
  const sparse::LdlSchedule& schedule() const;
  int size() const { return nv + nc; }
};

/// The order in which rows of K are eliminated. kContactsEarly looks at the contacts' J in a posture without symmetry,
/// so it depends on the contacts' types, axes and places on A's bodies, as well as on the trees.
std::vector<int> elimination_order(const Scene& scene, const Island& island, const IslandSupport& support, Order order);

/// perm: by elimination_order.
KktPattern analyze(const Scene& scene, const Island& island, const IslandSupport& support, Order order,
                   std::vector<int> perm);

}  // namespace manycontact
