#pragma once
// Finds nodes of symplectic Euler (q' = q (+) h v'), and makes their lq::SymplecticStructure.

#include "manycontact/control/euler.hpp"
#include "manycontact/detail/control/augmented_action.hpp"
#include "manycontact/lq/problem.hpp"

namespace manycontact::internal {

/// Returns a node's Euler data, also if an augmented Lagrangian wraps the node; nullptr for other nodes.
const IntegratedActionDataEuler* find_euler(const ActionDataAbstract& node);
/// Returns the Euler data of a node that has such data, for writing.
inline IntegratedActionDataEuler& euler_of(ActionDataAbstract& node) {
  return const_cast<IntegratedActionDataEuler&>(*find_euler(node));
}
/// Returns find_euler if the derivatives have the symplectic structure: the joints are known, and the node is no class
/// derived from IntegratedActionModelEuler, or it stores no matrices. Otherwise returns nullptr.
const IntegratedActionDataEuler* known_steps(const ActionModelAbstract& model, const ActionDataAbstract& node);
/// Sets out.J = J1 and out.G = h J2 of the node's last calcDiff. Allocates at the first call only.
void fill_steps(const IntegratedActionDataEuler& euler, lq::SymplecticStructure& out);

}  // namespace manycontact::internal
