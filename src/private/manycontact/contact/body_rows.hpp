#pragma once
// One contact's rows on its two bodies, for deep trees: each body in its own body frame
// (algorithm/body_kinematics.hpp), and no columns of joints, of which there may be many.

#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/contact/rows.hpp"

namespace manycontact {

/// Fills `data` but J_l and J; aMA, bMA are A in A's and in B's body frame (a fixed base's; the world). kinA, kinB: of
/// the robots of A and B, nullptr where the body cannot move (a fixed base, the world). aA, aB: accelerations minus
/// gravity of A's and B's bodies in their body frames; unused where these cannot move.
void body_rows(const Scene& scene, const Contact& contact, const BodyKinematics<double>* kinA,
               const BodyKinematics<double>* kinB, const Vec6<double>& aA, const Vec6<double>& aB,
               ContactData<double>& data);

}  // namespace manycontact
