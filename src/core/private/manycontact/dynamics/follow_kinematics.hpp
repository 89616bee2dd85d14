#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Computes kinematics as update_kinematics (dynamics/views.hpp), without checks. NaN if q or v is not finite.
void follow_kinematics(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v, SceneData& data);

}  // namespace manycontact
