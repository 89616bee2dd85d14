#pragma once
// Finds nodes of symplectic Euler (q' = q (+) h v'), and makes their lq::SymplecticStructure.

#include "manycontact/control/euler.hpp"
#include "manycontact/detail/control/augmented_action.hpp"
#include "manycontact/lq/problem.hpp"

namespace manycontact::internal {

/// Returns the Euler data of a node, also if an augmented Lagrangian wraps the node, or null for other nodes.
const IntegratedActionDataEuler* find_euler(const ActionDataAbstract& node);
inline IntegratedActionDataEuler& euler_of(ActionDataAbstract& node) {
  return const_cast<IntegratedActionDataEuler&>(*find_euler(node));
}
/// Returns find_euler(node) if the derivatives are known to have the symplectic structure, otherwise null. They have it
/// if joints_are_known, and the node stores no matrices or its class is exactly IntegratedActionModelEuler.
const IntegratedActionDataEuler* known_steps(const ActionModelAbstract& model, const ActionDataAbstract& node);
/// Sets out.J = J1, out.G = h J2 (derivatives of x (+) dx) from a node's last calcDiff. Allocates in the first call.
void fill_steps(const IntegratedActionDataEuler& euler, lq::SymplecticStructure& out);

}  // namespace manycontact::internal
