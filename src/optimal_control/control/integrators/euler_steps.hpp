#pragma once
// Access to the nodes of symplectic Euler as lq::SymplecticStructure: q' = q (+) h v'.

#include "manycontact/control/euler.hpp"
#include "manycontact/detail/control/augmented_action.hpp"
#include "manycontact/lq/problem.hpp"

namespace manycontact::internal {

/// Returns the Euler data within a node's data, which an augmented Lagrangian may wrap; nullptr if there are none.
const IntegratedActionDataEuler* find_euler(const ActionDataAbstract& node);
/// Returns find_euler of a node that has Euler data.
inline IntegratedActionDataEuler& euler_of(ActionDataAbstract& node) {
  return const_cast<IntegratedActionDataEuler&>(*find_euler(node));
}
/// Returns find_euler if the joints are known, and the node is IntegratedActionModelEuler itself (derived classes may
/// have other derivatives) or stores no matrices; otherwise nullptr.
const IntegratedActionDataEuler* known_steps(const ActionModelAbstract& model, const ActionDataAbstract& node);
/// Sets J1 and h J2; allocates at the first call only.
void fill_steps(const IntegratedActionDataEuler& euler, lq::SymplecticStructure& out);

}  // namespace manycontact::internal
