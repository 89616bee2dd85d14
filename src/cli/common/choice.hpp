#pragma once
// What the methods and orders would cost on an island, and why one was chosen.

#include <array>
#include <optional>

#include "manycontact/dynamics/data.hpp"

namespace manycontact::cli {

struct OrderCost {
  Order order = Order::kLeafToRoot;
  int nonzeros = 0;             // of L, diagonal included
  double ldl = 0, cholmod = 0;  // predicted, us
};

struct IslandCosts {
  long K_nonzeros = 0;  // both triangles
  std::array<OrderCost, std::size(kOrders)> orders;
  std::optional<double> supernodal;  // none: not built in, or no contacts
  double dense = 0;
};
double predicted_dense(const IslandData& island);
IslandCosts predict_costs(const Scene& scene, const IslandData& island);

/// "sparse-ldl in leaf-to-root order, predicted 12 us against 31 us for sparse-supernodal": what the choice rests on.
std::string why_chosen(const Options& options, const IslandData& island, const IslandCosts& costs);
/// What happened to that choice in the last solve, empty when it answered.
std::string why_changed(const IslandData& island, const IslandReport& report);

/// Whether a method has an order of elimination.
bool has_order(Method method);
/// Non-zeros of K, both triangles, without the contact rows' diagonal where it is zero.
long nonzeros_of_K(const KktPattern& pattern, double damping);

}  // namespace manycontact::cli
