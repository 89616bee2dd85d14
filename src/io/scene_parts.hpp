#pragma once
// The steps of read_scene, in their order: robots (with models, copies, state), then contacts.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "manycontact/io/scene_file.hpp"
#include "manycontact/io/urdf.hpp"
#include "xml.hpp"

namespace manycontact::io {

/// A <robot> element as written.
struct RobotElement {
  explicit RobotElement(const Element& e) : element(e) {}

  Element element;
  RobotGroup group;
  UrdfOptions options;
  bool gravity_torques = false;           // u="gravity"
  std::map<std::string, Element> joints;  // <joint>, by joint
  std::map<std::string, Element> locks;   // <lock>, by joint
};

/// One robot's configuration, velocity, torques; of a copied robot before it is arranged.
struct RobotState {
  Eigen::VectorXd q, v, u;
};

/// Models by file and options, so that equal robots share one.
class ModelCache {
 public:
  std::shared_ptr<const Model> get(const RobotElement& robot);

 private:
  std::map<std::string, std::shared_ptr<const Model>> models_;
};

/// `scene_folder`: relative URDF paths start there.
RobotElement read_robot(const Element& element, const std::string& scene_folder);

/// State from xyz, rpy, <q>, <v>, <u>, <joint>, u="gravity".
RobotState read_state(const RobotElement& robot, const Model& model);

/// xyz and rpy of <robot>.
SE3<double> read_base(const Element& robot);

/// Where copy i of n stands: `arrange` and `spacing`.
struct Arrangement {
  int kind = 0;  // line, circle, grid
  double spacing = 1;
  int count = 1;
  /// Translation and yaw of copy i.
  void place(int i, Vec3<double>& translation, double& yaw) const;
};

/// Adds all robots to the scene, with q, v, u (NaN for u="gravity").
void add_robots(const Element& scene, SceneFile& out);

/// Adds all contacts; out.q must be complete.
void add_contacts(const Element& scene, SceneFile& out);

/// The quaternion x, y, z, w made unit; refuses one that is not within 1e-6 of it.
void normalise_quaternion(const Where& where, const std::string& what, Eigen::Ref<Eigen::Vector4d> quat);

}  // namespace manycontact::io
