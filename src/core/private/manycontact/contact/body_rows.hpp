#pragma once
// Constraint rows of one contact of deep trees, in body frames (algorithm/body_kinematics.hpp), without J_l and J.

#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

/// Fills `data` except J_l and J. aMA, bMA: A in the body frames of A and B (fixed base, world). kinA, kinB: of the
/// robots; nullptr if fixed. aA, aB: accelerations of the bodies minus gravity, in body frames; unused if fixed.
void body_rows(const Scene& scene, const Contact& contact, const BodyKinematics<double>* kinA,
               const BodyKinematics<double>* kinB, const Vec6<double>& aA, const Vec6<double>& aB,
               ContactData<double>& data);

}  // namespace manycontact
