#pragma once
// The steps of read_scene in order: robots (models, copies, state), contacts, external wrenches, springs, poses.

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

/// The elements of a scene file and of the files it includes, in reading order.
struct SceneElements {
  std::vector<std::unique_ptr<XmlFile>> files;
  std::vector<Element> robots, contacts, wrenches, springs, poses;
};

/// Adds an element's name to `names`. Throws InputError for a duplicate. what: kind of element, for the message.
void add_name(const Element& e, const std::string& what, const std::string& name,
              std::unordered_map<std::string, Where>& names);

/// Calls `add`; rethrows its std::invalid_argument as an InputError at the element.
template <class Add>
void add_or_fail(const Element& e, Add&& add) {
  try {
    add();
  } catch (const std::invalid_argument& error) {
    e.fail(error.what());
  }
}

/// The content of a <robot> element.
struct RobotElement {
  explicit RobotElement(const Element& e) : element(e) {}

  Element element;
  RobotGroup group;
  UrdfOptions options;
  bool gravity_torques = false;           // u="gravity"
  std::map<std::string, Element> joints;  // <joint> children by joint name
  std::map<std::string, Element> locks;   // <lock> children by joint name
};

/// Configuration, velocity and torques of one robot, before `arrange` moves copies.
struct RobotState {
  Eigen::VectorXd q, v, u;
};

/// Reads the state from xyz, rpy, <q>, <v>, <u>, <joint>, u="gravity".
RobotState read_state(const RobotElement& robot, const Model& model);

/// Reads xyz and rpy of <robot>.
SE3<double> read_base(const Element& robot);

/// Adds all robots to the scene, with q, v, u (NaN for u="gravity").
void add_robots(const std::vector<Element>& elements, SceneFile& out);

/// One end of a contact or spring: "robot/link", "copies/link" for all copies, or "copies+k/link" for shifted copies.
struct End {
  int first = -1;        // the robot, or the first copy
  int count = 1;         // number of copies
  bool copied = false;   // whether the name means all copies
  bool shifted = false;  // whether the name has +k or -k
  long long shift = 0;   // k: copy i of the other end is paired with copy i + k
  Frame frame;

  /// The attachment to the frame on a robot, with an offset in the frame's axes.
  Attachment on(int robot, const SE3<double>& offset) const {
    return {robot, frame.joint, frame.placement * offset, frame.name};
  }
};

/// The two ends of a contact or a spring: attributes `frame` (A) and `to` (B, if given), with equal numbers of copies.
struct EndPair {
  End A, B;
  bool to_robot = false, wrap = false;
  /// The robot of B that is paired with copy i of A; nullopt if there is none.
  std::optional<int> target(int i) const;
};

/// Looks up "robot/link", "copies/link" and "copies+k/link" in a scene with all its robots.
class EndReader {
 public:
  explicit EndReader(const SceneFile& scene);

  /// Reads the end in a required attribute.
  End read(const Element& e, const char* attribute);
  /// Reads an attribute without +k and -k; a copied robot's name means all copies.
  End read_first(const Element& e, const char* attribute);
  /// Reads the attributes frame, to and wrap.
  EndPair read_pair(const Element& e);
  /// Looks up the robot, or the group of copied robots, that an attribute names. The end's `frame` remains empty.
  End robot(const Element& e, const char* attribute, const std::string& name) const;

 private:
  bool find_robot(const std::string& name, End& end) const;
  bool find_shifted(const Where& here, const std::string& text, End& end) const;
  const std::unordered_map<std::string, int>& frames_of(const Model& model);
  const SceneFile& scene_;
  std::unordered_map<std::string, int> groups_;  // index into robot_groups of copied robots
  std::unordered_map<const Model*, std::unordered_map<std::string, int>> frames_;
};

/// Adds all contacts; out.q must be complete.
void add_contacts(const std::vector<Element>& elements, SceneFile& out);

/// Adds all external wrenches, springs between points and springs in joints; out.q must be complete.
void add_wrenches(const std::vector<Element>& elements, SceneFile& out);
void add_springs(const std::vector<Element>& elements, SceneFile& out);
void add_joint_springs(const std::vector<Element>& robots, SceneFile& out);

/// Adds the poses of a <pose> element, one per copy.
void read_pose(const Element& e, const Scene& scene, EndReader& ends, std::vector<ScenePose>& out);
void add_poses(const std::vector<Element>& elements, SceneFile& out);

/// Reads the attribute reference_frame; `local` if it is missing.
ReferenceFrame read_reference_frame(const Element& e);

/// Normalises a quaternion x, y, z, w. Throws InputError if its norm differs from 1 by more than 1e-6.
void normalise_quaternion(const Where& where, const std::string& what, Eigen::Ref<Eigen::Vector4d> quat);

/// Reads a rotation from an attribute x y z w; returns false if it is missing.
bool read_quaternion(const Element& e, const char* attribute, Mat3<double>& R);

}  // namespace manycontact::io
