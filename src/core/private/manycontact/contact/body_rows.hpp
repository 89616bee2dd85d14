#pragma once
// One contact's rows for deep trees, in body frames (algorithm/body_kinematics.hpp), without columns of joints.

#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

/// Fills `data` except J_l and J. aMA, bMA: A in A's and B's body frame (fixed base, world). kinA, kinB: of the robots,
/// or nullptr if fixed. aA, aB: accelerations of the bodies minus gravity, in body frames; unused if fixed.
void body_rows(const Scene& scene, const Contact& contact, const BodyKinematics<double>* kinA,
               const BodyKinematics<double>* kinB, const Vec6<double>& aA, const Vec6<double>& aB,
               ContactData<double>& data);

}  // namespace manycontact
