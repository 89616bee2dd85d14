#pragma once
// Contact rows that are redundant at the start of a motion, but independent at nearby configurations.
//
// A mechanism such as Bricard's is overconstrained: its rows are redundant where the loop is closed, but no longer
// after integration errors of 1e-9 m. Rows that the current solution finds redundant are therefore treated as redundant
// in later solves. This ends when contacts are misplaced by more than a hundredth of the largest moment arm, or when
// the contacts that couple their robots change.

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Call it after solve. From then on exactly the rows that are redundant in its solution are treated as redundant.
void keep_dependent(SceneData& data);
/// Does the same in other data, for a scene with the same robots and contacts.
void keep_dependent_as(const SceneData& of, const Scene& scene, SceneData& data);
/// Forgets all rows remembered to depend on each other: the data go on with other states.
void forget_dependent(SceneData& data);

/// Returns, for each velocity coordinate, the error that J's entries in rows of lengths may have, in their units: the
/// tolerance or the drift within which rows of its island were found to depend on each other at the last solve. 0 where
/// they depend exactly, or not at all.
Eigen::VectorXd inaccuracy_of(const Scene& scene, const SceneData& data);

}  // namespace manycontact
