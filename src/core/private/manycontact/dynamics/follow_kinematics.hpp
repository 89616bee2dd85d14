#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Does what update_kinematics (dynamics/views.hpp) does, in a state that is not validated, such as a solver's trial:
/// placements are NaN where q or v are not finite.
void follow_kinematics(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v, SceneData& data);

}  // namespace manycontact
