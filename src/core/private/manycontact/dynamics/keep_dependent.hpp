#pragma once
// Contact rows that depend on each other at the start of a motion, and only there.
//
// A mechanism such as Bricard's is overconstrained: its rows depend on each other on the closed loop, and not in its
// neighbourhood, where integration takes it by 1e-9 m. Rows found dependent by the current solution are dependent
// in the solves to come, while contacts are misplaced by no more than a hundredth of the largest moment arm and as long
// as the contacts that join their robots stay.

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// After solve: from here on rows that depend on each other in its solution do; those that do not, do no longer.
void keep_dependent(SceneData& data);
/// The same in other data, of a scene with the same robots and contacts.
void keep_dependent_as(const SceneData& of, const Scene& scene, SceneData& data);
/// Forgets all rows remembered to depend on each other: the data go on with other states.
void forget_dependent(SceneData& data);

/// Returns, for each velocity coordinate, the error that J's entries in rows of lengths may have, in their units: the
/// tolerance or the drift within which rows of its island were found to depend on each other at the last solve. 0 where
/// they depend exactly, or not at all.
Eigen::VectorXd inaccuracy_of(const Scene& scene, const SceneData& data);

}  // namespace manycontact
