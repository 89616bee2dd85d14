#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Same as update_kinematics (dynamics/views.hpp) without checks; NaN if q or v is not finite, as in a solver's trial.
void follow_kinematics(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v, SceneData& data);

}  // namespace manycontact
