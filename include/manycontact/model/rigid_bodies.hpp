#pragma once
// What algorithm/rigid_body.hpp and algorithm/configuration.hpp compute with: all robots of a scene, one of them, or a
// model alone. A view: the scene or model must outlive it.
//
// q, v, tau and everything else by coordinates are those of these robots one after the other: of a scene the scene's,
// of one robot its own nq and nv numbers.

#include <span>

#include "manycontact/model/scene.hpp"

namespace manycontact {

class RigidBodies {  // all robots of a scene, one of them, or a model alone
 public:
  /// All robots of a scene.
  RigidBodies(const Scene& scene) : scene_(&scene) {}
  /// One of them, with q and v of its own. Throws std::invalid_argument for a name that does not exist.
  RigidBodies(const Scene& scene, const std::string& robot);
  /// A model alone. model: finalized, or std::invalid_argument is thrown. base: where its base stands. gravity: m/s^2.
  RigidBodies(const Model& model, const SE3<double>& base = {}, const Vec3<double>& gravity = {0, 0, -9.81});

  std::span<const Robot> robots() const;                                               // in their order
  const Vec3<double>& gravity() const { return scene_ ? scene_->gravity : gravity_; }  // m/s^2
  int nq() const;                                                                      // numbers in q
  int nv() const;                                                                      // and in v
  int njoints() const;  // movable ones, floating bases included
  /// The springs in joints of the scene, all of them: those of other robots too. None of a model alone.
  std::span<const JointSpring> joint_springs() const {
    return scene_ ? std::span<const JointSpring>(scene_->joint_springs) : std::span<const JointSpring>();
  }
  /// The first robot's number in its scene; 0 of a model alone.
  int first() const { return first_; }
  /// First coordinate of one of robots() in q.
  int idx_q(const Robot& robot) const { return robot.idx_q - robots().front().idx_q; }
  /// And in v.
  int idx_v(const Robot& robot) const { return robot.idx_v - robots().front().idx_v; }

 private:
  const Scene* scene_ = nullptr;
  int first_ = 0, count_ = -1;  // of the scene's robots; -1: all
  std::optional<Robot> alone_;
  Vec3<double> gravity_;
};

/// A joint of a robot.
struct BodyJoint {
  int robot = 0, joint = 0;  // numbers in the scene (0: of a model alone), in the model
};

/// By name: "knee" where there is one robot, "r0/knee" always. A frame is a link, or the link that a joint of that name
/// carries, fixed ones too. Throw std::invalid_argument for a name that does not exist, with the nearest one.
Attachment frame_called(const RigidBodies& bodies, const std::string& name);
BodyJoint joint_called(const RigidBodies& bodies, const std::string& name);

/// All names, in the order of numbers: "knee" where there is one robot, else "r0/knee".
std::vector<std::string> frame_names(const RigidBodies& bodies);
std::vector<std::string> joint_names(const RigidBodies& bodies);

}  // namespace manycontact
