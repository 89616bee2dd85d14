#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// As update_kinematics (dynamics/views.hpp), of a state that nobody has judged, such as a solver's trial: places are
/// not numbers where q or v are none.
void follow_kinematics(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v, SceneData& data);

}  // namespace manycontact
