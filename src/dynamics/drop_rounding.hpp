#pragma once
// For doubles, and for packs of robots side by side.

#include <limits>

#include "manycontact/algorithm/crba.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

/// The inertia m about a joint's column J, of bodies whose composite inertia is Y; zero where that is no more than
/// their rounding.
template <class S, class Column>
S without_rounding(const S& m, const Column& J, const Inertia<S>& Y) {
  const S rounding(tolerance::kRounding * std::numeric_limits<double>::epsilon());
  const S terms = J.template head<3>().squaredNorm() * Y.m + J.template tail<3>().squaredNorm() * Y.I.trace();
  return select(absolute(m) <= rounding * terms, S(0), m);
}

/// A coordinate whose inertia is no more than rounding of its bodies', as that of a point mass on the joint's axis, has
/// none. No pivot shows that: it may have nothing to cancel with. After crba. slot: as there; nullptr where it had
/// none.
template <class S>
void drop_rounding(const Model& model, const Kinematics<S>& kin, const std::vector<Inertia<S>>& Yc, const int* slot,
                   S* M) {
  for (int i = 0; i < model.nv; ++i) {
    S& m = M[slot ? slot[model.M_begin[i]] : model.M_begin[i]];
    m = without_rounding<S>(m, kin.J.col(i), Yc[model.dof_joint[i]]);
  }
}

}  // namespace manycontact::internal
