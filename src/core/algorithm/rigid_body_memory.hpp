#pragma once
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "manycontact/algorithm/aba.hpp"
#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/detail/algorithm/rnea_derivatives.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact::internal {

using ConstRef = ConstVectorRef;

struct RobotMemory {
  explicit RobotMemory(const Model& m) : model(&m), kin(m), f(static_cast<std::size_t>(m.njoints())), diagonal(m.nv) {}

  const Model* model;
  Kinematics<double> kin;           // kinematics at the state of the data
  std::vector<Inertia<double>> Yc;  // composite inertias; valid if RigidBodyMemory::composed
  std::vector<Vec6<double>> f;      // njoints: wrenches that joints transmit to their subtrees, in the tree frame
  std::vector<Vec6<double>> fext;   // njoints: external forces, in the tree frame
  std::vector<double> M;            // packed M, overwritten with its factor by inverse_inertia_times, aba_derivatives
  Eigen::VectorXd diagonal;         // scratch: diagonal of M
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> panel;  // right-hand sides of M
  std::optional<AbaData<double>> aba;
  std::optional<RneaDerivatives> derivatives;
};

struct RigidBodyMemory {
  std::vector<RobotMemory> robots;
  Eigen::VectorXd zero, v, a;  // nv entries: zeros; v and a of the state
  Eigen::VectorXd q;           // nq entries: q of the state
  bool moving = false;         // whether kin.v and kin.a are computed for the state; if not, the state has v = 0
  bool composed = false;       // whether Yc and M belong to the state
  bool carries = false;        // whether f is from an inverse dynamics at the state
  Eigen::VectorXd tau, h, g, qdd, driving;
  Eigen::MatrixXd M;
  TorqueDerivatives torque;
  AccelerationDerivatives acceleration;
};

/// Returns the memory of the data. Throws std::invalid_argument if the data were made for other robots.
inline RigidBodyMemory& memory_of(const char* function, const RigidBodies& bodies, const RigidBodyData& data) {
  const std::span<const Robot> robots = bodies.robots();
  bool fits = data.memory && data.memory->robots.size() == robots.size();
  for (std::size_t r = 0; fits && r < robots.size(); ++r) fits = data.memory->robots[r].model == robots[r].model.get();
  if (!fits)
    throw std::invalid_argument(std::string(function) +
                                ": the data belong to other robots, make data for these robots");
  return *data.memory;
}

/// Calls act(robot, its memory, first coordinate in q, first coordinate in v) for each robot.
template <class Act>
void each_robot(const RigidBodies& bodies, RigidBodyMemory& m, Act&& act) {
  const std::span<const Robot> robots = bodies.robots();
  for (std::size_t r = 0; r < robots.size(); ++r)
    act(robots[r], m.robots[r], bodies.idx_q(robots[r]), bodies.idx_v(robots[r]));
}

/// Calls act(spring, its coordinate in q, its coordinate in v) for each joint spring of these robots.
template <class Act>
void each_joint_spring(const RigidBodies& bodies, Act&& act) {
  const std::span<const Robot> robots = bodies.robots();
  for (const JointSpring& spring : bodies.joint_springs()) {
    const int r = spring.robot - bodies.first();
    if (r < 0 || r >= static_cast<int>(robots.size())) continue;
    const Robot& robot = robots[static_cast<std::size_t>(r)];
    const Joint& joint = robot.model->joints[spring.joint];
    act(spring, bodies.idx_q(robot) + joint.idx_q, bodies.idx_v(robot) + joint.idx_v);
  }
}

void move(const RigidBodies& bodies, RigidBodyMemory& m);     // computes kin.v and kin.a, unless done
void compose(const RigidBodies& bodies, RigidBodyMemory& m);  // computes Yc and M, unless done

}  // namespace manycontact::internal
