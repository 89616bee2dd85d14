#pragma once
// The rigid-body model of a state: a scene's robots and numbered frames. It corresponds to Crocoddyl's pinocchio model.

#include <memory>

#include "manycontact/detail/action/fwd.hpp"

namespace manycontact {

class Multibody {  // The robots and frames of a scene.
 public:
  /// A frame: robot, joint (-1: the robot's fixed base) and placement on the joint's body.
  struct BodyFrame {
    std::string name;  // "frame" if there is one robot, else "robot/frame"
    RobotIndex robot = 0;
    JointIndex joint = -1;
    SE3<double> placement;
  };

  /// Copies the robots and gravity of a scene, without contacts and damping (see contacts_of_scene in contact.hpp).
  explicit Multibody(const Scene& scene);
  /// Makes a model of one robot. base: placement of a fixed base in the world.
  explicit Multibody(std::shared_ptr<const Model> model, const SE3<double>& base = {});

  int nq = 0, nv = 0;
  std::vector<BodyFrame> frames;
  Eigen::VectorXd armature;     // nv
  Eigen::VectorXd effortLimit;  // nv; infinite if the file has none, and for floating bases

  const Scene& scene() const { return scene_; }  // the robots, with their gravity
  /// Returns the number of a frame: "r0/left_sole", or "left_sole" if there is one robot. A joint's name gives the
  /// frame of its link, unless a link has that name. Throws std::invalid_argument for an unknown name.
  FrameIndex getFrameId(const std::string& name) const;
  /// Returns whether there is a frame with this name.
  bool existFrame(const std::string& name) const { return find(name) != nullptr; }

 private:
  void index();
  const std::size_t* find(const std::string& name) const;
  Scene scene_;
  std::unordered_map<std::string, std::size_t> frame_index_;
};

}  // namespace manycontact
