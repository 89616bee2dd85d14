#pragma once
// The first argument of the functions in algorithm/rigid_body.hpp and algorithm/configuration.hpp: all robots of a
// scene, one robot of it, or a model alone. The argument is a view, so that the scene or model must outlive it.
//
// q, v, tau and all other vectors contain the coordinates of these robots, robot after robot. For a scene their sizes
// are nq and nv of the scene, for one robot those of this robot.

#include <span>

#include "manycontact/model/scene.hpp"

namespace manycontact {

class RigidBodies {  // all robots of a scene, one of its robots, or a model alone
 public:
  /// Selects all robots of a scene.
  RigidBodies(const Scene& scene) : scene_(&scene) {}
  /// Selects one robot. Vectors q and v then contain the coordinates of this robot only. Throws std::invalid_argument
  /// for an unknown name.
  RigidBodies(const Scene& scene, const std::string& robot);
  /// Selects a model alone. base: placement of the model's base in the world. gravity: m/s^2. Throws
  /// std::invalid_argument if the model is not finalized.
  RigidBodies(const Model& model, const SE3<double>& base = {}, const Vec3<double>& gravity = {0, 0, -9.81});

  std::span<const Robot> robots() const;  // the robots in the order of their coordinates
  const Vec3<double>& gravity() const { return scene_ ? scene_->gravity : gravity_; }  // m/s^2
  int nq() const;                                                                      // number of coordinates of q
  int nv() const;                                                                      // number of coordinates of v
  int njoints() const;  // movable joints, floating bases included
  /// Returns all joint springs of the scene, also those of robots that are not selected; empty for a model alone.
  std::span<const JointSpring> joint_springs() const {
    return scene_ ? std::span<const JointSpring>(scene_->joint_springs) : std::span<const JointSpring>();
  }
  /// Returns the number of the first selected robot in its scene; 0 for a model alone.
  int first() const { return first_; }
  /// Returns the index in q of the first coordinate of a robot in robots().
  int idx_q(const Robot& robot) const { return robot.idx_q - robots().front().idx_q; }
  /// Returns the index in v of the first coordinate of a robot in robots().
  int idx_v(const Robot& robot) const { return robot.idx_v - robots().front().idx_v; }

 private:
  const Scene* scene_ = nullptr;
  int first_ = 0, count_ = -1;  // range of the scene's robots; count_ -1: all robots
  std::optional<Robot> alone_;
  Vec3<double> gravity_;
};

/// A joint of a robot.
struct BodyJoint {
  RobotIndex robot = 0;  // 0: a model alone
  JointIndex joint = 0;
};

/// Finds a frame by name: "r0/left_sole", or "left_sole" if there is only one robot. A frame is a link, or the child
/// link of the joint with this name, which may be a fixed joint. Throws std::invalid_argument for an unknown name, and
/// suggests the nearest name.
Attachment find_frame(const RigidBodies& bodies, const std::string& name);
/// Finds a joint by name: "r0/knee", or "knee" if there is only one robot. Throws std::invalid_argument for an unknown
/// name, and suggests the nearest name.
BodyJoint find_joint(const RigidBodies& bodies, const std::string& name);

/// Return the names of all frames or all joints, in the order of their numbers: "r0/knee", or "knee" if there is only
/// one robot.
std::vector<std::string> frame_names(const RigidBodies& bodies);
std::vector<std::string> joint_names(const RigidBodies& bodies);

}  // namespace manycontact
