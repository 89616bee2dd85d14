#pragma once
// Constraint rows of one contact on deep trees, in body frames (algorithm/body_kinematics.hpp), without J_l and J.

#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

/// Computes `data` except J_l and J. data.aMA and data.bMA are the placements of A in the body frames of A and B; an
/// immovable body has the frame of its base or of the world. kinA, kinB: kinematics of the robots of A and B, nullptr
/// for an immovable body. aA, aB: accelerations minus gravity of the bodies, in body frames; unused if immovable.
void body_rows(const Scene& scene, const Contact& contact, const BodyKinematics<double>* kinA,
               const BodyKinematics<double>* kinB, const Vec6<double>& aA, const Vec6<double>& aB,
               ContactData<double>& data);

}  // namespace manycontact
