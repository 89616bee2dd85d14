#pragma once
#include <memory>

#include "manycontact/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact::internal {

/// Kinematics of one robot at rest, its memory used again for the next of the same model.
class AtRest {
 public:
  AtRest(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q) : scene_(scene), q_(q) {}

  const Kinematics<double>& of(int r) {
    if (r == robot_) return *kin_;
    const Robot& robot = scene_.robots[r];
    if (robot_ < 0 || scene_.robots[robot_].model != robot.model) {
      kin_ = std::make_unique<Kinematics<double>>(*robot.model);
      rest_.setZero(robot.model->nv);
    }
    robot_ = r;
    forward_kinematics<double>(*robot.model, robot.base, q_.segment(robot.idx_q, robot.model->nq), *kin_);
    forward_accelerations<double>(*robot.model, rest_, nullptr, scene_.gravity, *kin_);
    return *kin_;
  }

 private:
  const Scene& scene_;
  const Eigen::Ref<const Eigen::VectorXd>& q_;
  int robot_ = -1;
  std::unique_ptr<Kinematics<double>> kin_;
  Eigen::VectorXd rest_;
};

}  // namespace manycontact::internal
