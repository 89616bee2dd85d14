#pragma once
// Nodes of symplectic Euler, whose new configuration is the old one stepped by the new velocity, as
// lq::SymplecticStructure.

#include "manycontact/control/euler.hpp"
#include "manycontact/detail/control/augmented_action.hpp"
#include "manycontact/lq/problem.hpp"

namespace manycontact::internal {

/// The Euler data within a node's data, which an augmented Lagrangian may wrap; nullptr if there are none.
const IntegratedActionDataEuler* find_euler(const ActionDataAbstract& node);
/// The Euler data of a node that is known to have them.
inline IntegratedActionDataEuler& euler_of(ActionDataAbstract& node) {
  return const_cast<IntegratedActionDataEuler&>(*find_euler(node));
}
/// find_euler of a node that is IntegratedActionModelEuler itself (what is derived from it may have other derivatives),
/// or keeps no matrices, and whose joints are known.
const IntegratedActionDataEuler* known_steps(const ActionModelAbstract& model, const ActionDataAbstract& node);
/// Sets J1 and h J2; allocates at the first call only.
void fill_steps(const IntegratedActionDataEuler& euler, lq::SymplecticStructure& out);

}  // namespace manycontact::internal
