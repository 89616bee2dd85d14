#pragma once
// One contact's rows for deep trees, each body in its body frame (algorithm/body_kinematics.hpp), without columns of
// joints, of which there may be many.

#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

/// Fills `data` except J_l and J. aMA, bMA: A in A's and in B's body frame (of a fixed base, or the world). kinA, kinB:
/// of the robots of A and B; nullptr for fixed bodies. aA, aB: accelerations minus gravity of the bodies, in body
/// frames; unused for fixed bodies.
void body_rows(const Scene& scene, const Contact& contact, const BodyKinematics<double>* kinA,
               const BodyKinematics<double>* kinB, const Vec6<double>& aA, const Vec6<double>& aB,
               ContactData<double>& data);

}  // namespace manycontact
