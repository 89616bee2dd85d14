#pragma once
// Torques of the actuated coordinates among those of all.

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// tau (nv) of u (nu): zero where nothing is actuated.
inline void torques_of_motors(const Scene& scene, const ConstVectorRef& u, Eigen::VectorXd& tau) {
  tau.setZero();
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k) tau[robot.idx_v + robot.model->actuated[k]] = u[robot.idx_u + k];
}

}  // namespace manycontact
