#pragma once
// The sparse KKT matrix of an island, K = [M J^T; J -delta I], in an elimination order chosen for it.

#include <string>
#include <vector>

#include "manycontact/kkt/island.hpp"
#include "manycontact/sparse/ldl.hpp"

namespace manycontact {

/// Where the contact rows go among the joints. Joints go from the leaves to the root, which fills nothing in M.
enum class Order {
  kLeafToRoot,     // contacts last: sound whenever J has full rank
  kContactsEarly,  // a contact as soon as joints that move it in all its directions are eliminated; less fill
  kCamd,           // SuiteSparse CAMD, all joints before all contacts
};
inline constexpr Order kOrders[] = {Order::kLeafToRoot, Order::kContactsEarly, Order::kCamd};
std::string to_string(Order order);

/// The active contact rows' places: what K's pattern depends on, besides the trees.
struct IslandSupport {
  std::vector<ContactSupport> contacts;   // per contact of the island, numbered within the robots
  std::vector<std::vector<int>> columns;  // per contact: the same as columns of the island, a's first, then b's
};
IslandSupport island_support(const Scene& scene, const Island& island);

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

  int size() const { return nv + nc; }
};
KktPattern analyze(const Scene& scene, const Island& island, const IslandSupport& support, Order order);

/// Numbers that are equal for two islands only if all their patterns are.
std::vector<long> shape_key(const Scene& scene, const Island& island, const IslandSupport& support);

}  // namespace manycontact
