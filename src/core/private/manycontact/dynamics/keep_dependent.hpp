#pragma once
// Contact rows that are redundant at the start of a motion, but independent at nearby configurations.
//
// An overconstrained mechanism such as Bricard's has redundant rows only while the loop is closed, not after
// integration errors of 1e-9 m. Rows that are redundant in the current solution therefore remain so in later solves,
// until contact errors exceed a hundredth of the largest moment arm, or the contacts that couple their robots change.

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Lets later solves treat rows as redundant within a tolerance (file header), up to the number of rows that are
/// redundant in the current solution. Call it after solve.
void keep_dependent(SceneData& data);
/// Has the effect of keep_dependent on later solves of `data`, with the number that keep_dependent set in `of`. The
/// scene of `of` has the robots and contacts of `scene`.
void keep_dependent_as(const SceneData& of, const Scene& scene, SceneData& data);
/// Ends the effect of keep_dependent, for data that continue with other states.
void forget_dependent(SceneData& data);

/// Returns, per velocity coordinate, the possible error of J in translational rows [m/rad or m/m]: the tolerance or
/// constraint violation within which rows were made dependent. It is 0 if rows are exactly dependent, or independent.
Eigen::VectorXd inaccuracy_of(const Scene& scene, const SceneData& data);

}  // namespace manycontact
