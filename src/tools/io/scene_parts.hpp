#pragma once
// Steps of read_scene, in their order: robots (models, copies, state), contacts, external wrenches, springs, poses.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "manycontact/io/scene_file.hpp"
#include "manycontact/io/urdf.hpp"
#include "xml.hpp"

namespace manycontact::io {

struct SceneElements {  // the elements of a scene file and of the files it includes, in reading order
  std::vector<std::unique_ptr<XmlFile>> files;
  std::vector<Element> robots, contacts, wrenches, springs, poses;
};

/// Adds an element's name to `names`. Throws InputError for a duplicate. what: the kind of element, for the message.
void add_name(const Element& e, const std::string& what, const std::string& name,
              std::unordered_map<std::string, Where>& names);

/// Calls add(). If it throws std::invalid_argument, throws an InputError at the element instead.
template <class Add>
void add_or_fail(const Element& e, Add&& add) {
  try {
    add();
  } catch (const std::invalid_argument& error) {
    e.fail(error.what());
  }
}

struct RobotElement {  // the content of a <robot> element
  explicit RobotElement(const Element& e) : element(e) {}

  Element element;
  RobotGroup group;
  UrdfOptions options;
  bool gravity_torques = false;           // whether the element has u="gravity"
  std::map<std::string, Element> joints;  // <joint> children by joint name
  std::map<std::string, Element> locks;   // <lock> children by joint name
};

/// Configuration, velocity and torques of one robot, before the attribute `arrange` moves the copies.
struct RobotState {
  Eigen::VectorXd q, v, u;
};

/// Reads the state of a robot from xyz, rpy, <q>, <v>, <u>, <joint> and u="gravity".
RobotState read_state(const RobotElement& robot, const Model& model);

/// Reads the placement of a robot's base from the attributes xyz and rpy of <robot>.
SE3<double> read_base(const Element& robot);

/// Adds all robots to the scene, with q, v, u. For u="gravity", u is NaN.
void add_robots(const std::vector<Element>& elements, SceneFile& out);

/// One end of a contact or spring: "robot/link", "copies/link" for all copies, or "copies+k/link" for shifted copies.
struct End {
  int first = -1;        // the robot, or the first copy
  int count = 1;         // number of copies
  bool copied = false;   // whether the name refers to all copies
  bool shifted = false;  // whether the name contains +k or -k, as "copies+1/link" does
  long long shift = 0;   // the k of +k or -k: copy i of the other end is paired with copy i + k
  Frame frame;

  /// Returns the attachment to `frame` on the robot, displaced by `offset` in the frame's axes.
  Attachment on(int robot, const SE3<double>& offset) const {
    return {robot, frame.joint, frame.placement * offset, frame.name};
  }
};

struct EndPair {  // the two ends of a contact or a spring: A from the attribute `frame`, and B from `to` if it is given
  End A, B;
  bool to_robot = false, wrap = false;
  /// Returns the robot of B that is paired with copy i of A, or nullopt if there is none.
  std::optional<int> target(int i) const;
};

/// Looks up frames named "robot/link", "copies/link" or "copies+k/link". The scene must contain all its robots.
class EndReader {
 public:
  explicit EndReader(const SceneFile& scene);

  End read(const Element& e, const char* attribute);  // reads the end that a required attribute names
  /// Reads the end that a required attribute names without +k or -k. The name of a copied robot refers to all copies.
  End read_first(const Element& e, const char* attribute);
  EndPair read_pair(const Element& e);  // reads the attributes frame, to and wrap
  /// Looks up the robot, or the group of copied robots, called `name` in an attribute. The end's `frame` remains empty.
  End robot(const Element& e, const char* attribute, const std::string& name) const;

 private:
  bool find_robot(const std::string& name, End& end) const;
  bool find_shifted(const Where& here, const std::string& text, End& end) const;
  const std::unordered_map<std::string, int>& frames_of(const Model& model);
  const SceneFile& scene_;
  std::unordered_map<std::string, int> groups_;  // key: name of a copied robot; value: its index in robot_groups
  std::unordered_map<const Model*, std::unordered_map<std::string, int>> frames_;
};

void add_contacts(const std::vector<Element>& elements, SceneFile& out);  // Adds all contacts. out.q must be complete.

/// Adds all external wrenches, springs between points and springs in joints. out.q must be complete.
void add_wrenches(const std::vector<Element>& elements, SceneFile& out);
void add_springs(const std::vector<Element>& elements, SceneFile& out);
void add_joint_springs(const std::vector<Element>& robots, SceneFile& out);

/// read_pose adds the poses of one <pose> element, one per copy of its robot; add_poses adds those of all elements.
void read_pose(const Element& e, const Scene& scene, EndReader& ends, std::vector<ScenePose>& out);
void add_poses(const std::vector<Element>& elements, SceneFile& out);

/// Reads the attribute reference_frame, which is `local` if missing.
ReferenceFrame read_reference_frame(const Element& e);

/// Normalises a quaternion x, y, z, w. Throws InputError if its norm differs from 1 by more than 1e-6.
void normalise_quaternion(const Where& where, const std::string& what, Eigen::Ref<Eigen::Vector4d> quat);

/// Reads a rotation from an attribute "x y z w". Returns false if the attribute is missing.
bool read_quaternion(const Element& e, const char* attribute, Mat3<double>& R);

}  // namespace manycontact::io
