#pragma once
// One contact's rows on its two bodies, for deep trees: each body in its own body frame
// (algorithm/body_kinematics.hpp), and no columns of joints, of which there may be many.

#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

/// Fills `data` except J_l and J. aMA and bMA are A in A's and in B's body frame (of a fixed base, or the world). kinA
/// and kinB are those of the robots of A and B, or nullptr if the body cannot move. aA and aB are the accelerations
/// minus gravity of the bodies of A and B in their body frames; they are unused for bodies that cannot move.
void body_rows(const Scene& scene, const Contact& contact, const BodyKinematics<double>* kinA,
               const BodyKinematics<double>* kinB, const Vec6<double>& aA, const Vec6<double>& aB,
               ContactData<double>& data);

}  // namespace manycontact
