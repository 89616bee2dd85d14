#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Same as update_kinematics (dynamics/views.hpp) without validation, e.g. for a solver's trial; placements are NaN if
/// q or v are not finite.
void follow_kinematics(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v, SceneData& data);

}  // namespace manycontact
