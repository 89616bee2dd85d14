#pragma once
// The steps of read_scene, in their order: robots (with models, copies, state), then contacts, external wrenches,
// springs and poses.

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

/// The elements of a scene file and of those it includes, in the order in which they are met.
struct SceneElements {
  std::vector<std::unique_ptr<XmlFile>> files;
  std::vector<Element> robots, contacts, wrenches, springs, poses;
};

/// Adds the name of an element. It refuses a name that is there already. what: "a robot".
void add_name(const Element& e, const std::string& what, const std::string& name,
              std::unordered_map<std::string, Where>& names);

/// Calls `add`. The element is blamed for what it refuses.
template <class Add>
void add_or_fail(const Element& e, Add&& add) {
  try {
    add();
  } catch (const std::invalid_argument& error) {
    e.fail(error.what());
  }
}

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

/// State from xyz, rpy, <q>, <v>, <u>, <joint>, u="gravity".
RobotState read_state(const RobotElement& robot, const Model& model);

/// xyz and rpy of <robot>.
SE3<double> read_base(const Element& robot);

/// Adds all robots to the scene, with q, v, u (NaN for u="gravity").
void add_robots(const std::vector<Element>& elements, SceneFile& out);

/// Looks up "robot/link" as written. The name of a copied robot means all its copies.
struct End {
  int first = -1;        // the robot, or the first copy
  int count = 1;         // number of copies
  bool copied = false;   // whether all copies are meant
  bool shifted = false;  // whether +k or -k is given
  long long shift = 0;   // k
  Frame frame;

  /// The frame on a robot, moved by an offset in its axes.
  Attachment on(int robot, const SE3<double>& offset) const {
    return {robot, frame.joint, frame.placement * offset, frame.name};
  }
};

/// The two ends of a contact or a spring: `frame`, and `to` where there is one, of as many copies.
struct EndPair {
  End A, B;
  bool to_robot = false, wrap = false;
  /// The robot of B that belongs to copy i of A's; nullopt: none does.
  std::optional<int> target(int i) const;
};

/// Looks up "robot/link", "copies/link", "copies+k/link" in a scene that has all its robots.
class EndReader {
 public:
  explicit EndReader(const SceneFile& scene);

  /// Reads an attribute that is required.
  End read(const Element& e, const char* attribute);
  /// Looks up a name that means all copies if it is that of a copied robot, without +k and -k.
  End read_first(const Element& e, const char* attribute);
  /// Reads the attributes frame, to and wrap.
  EndPair read_pair(const Element& e);
  /// The robot `name`, or copies, an attribute names; `frame` is left empty.
  End robot(const Element& e, const char* attribute, const std::string& name) const;

 private:
  bool find_robot(const std::string& name, End& end) const;
  bool find_shifted(const Where& here, const std::string& text, End& end) const;
  const std::unordered_map<std::string, int>& frames_of(const Model& model);
  const SceneFile& scene_;
  std::unordered_map<std::string, int> groups_;  // copied robots: index into robot_groups
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
/// Adds all poses.
void add_poses(const std::vector<Element>& elements, SceneFile& out);

/// The attribute reference_frame, `local` when it is missing.
ReferenceFrame read_reference_frame(const Element& e);

/// The quaternion x, y, z, w made unit; refuses one that is not within 1e-6 of it.
void normalise_quaternion(const Where& where, const std::string& what, Eigen::Ref<Eigen::Vector4d> quat);

/// The rotation of an attribute x y z w; false when it is missing.
bool read_quaternion(const Element& e, const char* attribute, Mat3<double>& R);

}  // namespace manycontact::io
