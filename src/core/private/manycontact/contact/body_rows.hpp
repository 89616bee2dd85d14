#pragma once
// Constraint rows of one contact on deep trees, in body frames (algorithm/body_kinematics.hpp), without J_l and J.

#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

/// Computes `data` except J_l and J. data.aMA, bMA: A in the body frames of A and B; in the base's or world's frame if
/// immovable. kinA, kinB: kinematics of their robots, or nullptr. aA, aB: accelerations minus gravity.
void body_rows(const Scene& scene, const Contact& contact, const BodyKinematics<double>* kinA,
               const BodyKinematics<double>* kinB, const Vec6<double>& aA, const Vec6<double>& aB,
               ContactData<double>& data);

}  // namespace manycontact
