#pragma once
// A scene from its XML file (src/doc/scene_file.md): robots with their copies and their state, contacts.

#include <optional>
#include <string>
#include <vector>

#include "manycontact/io/finding.hpp"
#include "manycontact/io/input_error.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// One <robot> element: a robot, or its copies. They are neighbours in the scene and share one model.
struct RobotGroup {
  std::string name;     // as in the file; copies are called name0, name1, ...
  std::string urdf;     // path of the file it came from
  bool copied = false;  // had a `copies` attribute
  int first = 0, count = 1;
  int line = 1;
};

/// One <contact> element: a contact, or its copies, neighbours in the scene.
struct ContactGroup {
  std::string name;  // as in the file; copies are called name0, name1, ... by the copy of frame A's robot
  bool copied = false;
  int first = 0, count = 1;  // count may be 0: no copy has the target asked for
  int line = 1;
};

/// A <pose> element, or one copy's: where a frame, or a robot's centre of mass, is to be in the world [m, rad]; angles
/// as in rpy. What is left out is open.
struct ScenePose {
  std::string name;  // "robot/link", or the robot's
  Attachment frame;
  bool center_of_mass = false;  // of the robot frame.robot
  std::optional<double> x, y, z, roll, pitch, yaw;
  std::string file;
  int line = 1;
};

/// A contact whose B' the file leaves out, at least in part: it is taken from q.
struct OpenReference {
  int contact = 0;
  bool position = false, orientation = false;  // what is left out
};

struct SceneFile {  // A scene, its state, and which elements of the file its robots and contacts came from.
  std::string path;
  std::vector<std::string> files;  // read for it: `path`, scenes it includes, URDFs, each once
  Scene scene;
  Eigen::VectorXd q, v, u;  // scene.nq, scene.nv, scene.nu
  std::vector<RobotGroup> robot_groups;
  std::vector<ContactGroup> contact_groups;
  std::vector<int> robot_group;     // per robot: index into robot_groups
  std::vector<SE3<double>> moved;   // per robot: from where its element places it to where `arrange` does
  std::vector<int> gravity_robots;  // robots with u="gravity", ascending
  std::vector<ScenePose> poses;
  std::vector<OpenReference> open_references;
  std::vector<int> open_lengths;  // springs whose length the file leaves out: it is what it is at q
  int consistent_line = 0;        // where consistent="true" stands in `path`; 0: it does not
  int restarts = 0;               // of the search for the poses (analysis/place.hpp)
  std::vector<Finding> findings;  // of the robots' files, by the first robot that has the model: "herd/knee"
};

/// Throws InputError. References left out are resolved from q. The torques u of gravity_robots are NaN, and q, v are as
/// they stand in the file also where it asks for poses or for consistent ones: all that takes a solver, and load_scene
/// (analysis/load_scene.hpp) sees to it.
SceneFile read_scene(const std::string& path);
/// The same of XML text, UTF-8 whatever it declares, as if it stood in the file `path`, which need not exist.
SceneFile read_scene_text(const std::string& text, const std::string& path);

}  // namespace manycontact
