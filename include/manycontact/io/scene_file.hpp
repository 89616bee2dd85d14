#pragma once

#include <optional>
#include <string>
#include <vector>

#include "manycontact/io/finding.hpp"
#include "manycontact/io/input_error.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// One <robot> element: a robot, or its copies. Copies are consecutive in the scene and share one model.
struct RobotGroup {
  std::string name;     // name in the file; copies are called name0, name1, ...
  std::string urdf;     // path of the robot's URDF file
  bool copied = false;  // whether the element has a `copies` attribute
  int first = 0, count = 1;
  int line = 1;
};

/// One <contact> element: a contact, or its copies. Copies are consecutive in the scene.
struct ContactGroup {
  std::string name;  // name in the file; copies are called name0, name1, ..., numbered as the copies of A's robot
  bool copied = false;
  int first = 0, count = 1;  // count is 0 if no copy has the requested target
  int line = 1;
};

/// A <pose> element, for one copy of its robot: the required placement of a frame, or of a robot's centre of mass, in
/// the world [m, rad]. Angles are those of the attribute rpy. Missing components are not required.
struct ScenePose {
  std::string name;  // "robot/link", or the robot's name
  Attachment frame;
  bool center_of_mass = false;  // whether the goal is the centre of mass of the robot frame.robot
  std::optional<double> x, y, z, roll, pitch, yaw;
  std::string file;
  int line = 1;
};

/// A contact whose target frame B' is missing in the file, at least in part. The missing part is computed from q.
struct OpenReference {
  ContactIndex contact = 0;
  bool position = false, orientation = false;  // whether this part is missing
};

struct SceneFile {  // A scene, its state, and the elements of the file that define its robots and contacts.
  std::string path;
  std::vector<std::string> files;  // all files read: `path`, included scenes, URDFs, each once
  Scene scene;
  Eigen::VectorXd q, v, u;  // scene.nq, scene.nv, scene.nu
  std::vector<RobotGroup> robot_groups;
  std::vector<ContactGroup> contact_groups;
  std::vector<int> robot_group;     // one entry per robot: index in robot_groups
  std::vector<SE3<double>> moved;   // displacement of each robot by `arrange`, relative to the placement in its element
  std::vector<int> gravity_robots;  // robots with u="gravity", ascending
  std::vector<ScenePose> poses;
  std::vector<OpenReference> open_references;
  std::vector<int> open_lengths;  // springs without a length in the file; it is computed at q
  int consistent_line = 0;        // the line of consistent="true" in `path`; 0: there is none
  int restarts = 0;               // number of restarts of the search for the poses (analysis/place.hpp)
  std::vector<Finding> findings;  // findings in robots' files, named after the first robot with the model: "herd/knee"
};

/// Reads a scene file. Missing references of contacts are computed from q. The torques u of gravity_robots are NaN. q
/// and v are those of the file. load_scene (analysis/load_scene.hpp) also computes the poses or the consistent state
/// that a file requests. Throws InputError. Thread-safe.
SceneFile read_scene(const std::string& path);
/// Reads UTF-8 XML text as read_scene reads a file at `path`, which need not exist. A declared encoding is ignored.
SceneFile read_scene_text(const std::string& text, const std::string& path);

}  // namespace manycontact
