#pragma once
// The rigid-body model behind a state: the robots of a scene, and their frames under one numbering. What
// `pinocchio::Model` is to Crocoddyl.

#include <memory>

#include "manycontact/action/fwd.hpp"

namespace manycontact {

class Multibody {  // robots and frames of a scene: pinocchio::Model to Crocoddyl
 public:
  /// A frame: robot, joint (-1: its fixed base) and placement on that joint's body.
  struct BodyFrame {
    std::string name;  // "frame" when there is one robot, else "robot/frame"
    int robot = 0, joint = -1;
    SE3<double> placement;
  };

  /// The robots and gravity of a scene; its contacts and damping are left out (see contacts_of_scene in contact.hpp).
  explicit Multibody(const Scene& scene);
  /// One robot; a fixed base stands at `base`.
  explicit Multibody(std::shared_ptr<const Model> model, const SE3<double>& base = {});

  int nq = 0, nv = 0;
  std::vector<BodyFrame> frames;
  Eigen::VectorXd armature;     // nv
  Eigen::VectorXd effortLimit;  // nv; infinite where the file gives none, and on floating bases

  const Scene& scene() const { return scene_; }
  /// "left_sole" when there is one robot, "r0/left_sole"; a joint's name is its link's, unless a link has that name.
  /// Throws std::invalid_argument for an unknown name.
  FrameIndex getFrameId(const std::string& name) const;
  bool existFrame(const std::string& name) const;

 private:
  void index();
  const std::size_t* find(const std::string& name) const;
  Scene scene_;
  std::unordered_map<std::string, std::size_t> frame_index_;
};

}  // namespace manycontact
