#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Computes the kinematics in `data` as update_kinematics (dynamics/views.hpp) does, without checks. They are NaN if q
/// or v is not finite.
void follow_kinematics(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v, SceneData& data);

}  // namespace manycontact
