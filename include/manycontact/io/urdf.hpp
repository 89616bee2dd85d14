#pragma once
// A robot from a URDF file.
//
// Fixed joints are merged into the parent's body, so are locked ones; every link stays usable as a frame.
// Joints are numbered depth first, children in byte order of their names (as urdfdom lists them). Masses and
// inertias are judged per moving body, after merging. With a fixed base the bodies merged into the root link
// are immovable and dropped.

#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "manycontact/model/model.hpp"

namespace manycontact {

struct UrdfOptions {           // What is said of a robot beside its file.
  bool floating_base = false;  // joint 0 is then "root", of type kFloating, carrying the root link
  double armature = 0;         // of every coordinate but the floating base's, kg m^2 (kg for prismatic)
  std::map<std::string, std::vector<double>> joint_armature = {};  // overrides it; one number, or one per coordinate
  std::map<std::string, double> locked = {};                       // joint frozen at this position; one-dof joints only
  bool refuse_mimic = false;                                       // a moving joint with <mimic> is an InputError
  std::set<std::string> passive = {};                              // joints without torques: Joint::actuated is false
  bool model_dynamics = false;  // <dynamics>: fills Model::damping and friction; else only noted

  bool operator==(const UrdfOptions&) const = default;
};

/// The options do not fit the robot: `joint` is unknown, fixed, has several coordinates, ...
struct UrdfOptionError : std::invalid_argument {
  UrdfOptionError(std::string joint_, bool lock_, const std::string& message)
      : std::invalid_argument(message), joint(std::move(joint_)), lock(lock_) {}  // message: what is wrong
  std::string joint;
  bool lock;  // from UrdfOptions::locked, else from an armature
};

/// Reads and finalizes. Limits are as URDF has them: efforts and velocities 0 or more, lower <= upper, which are 0
/// where they are not given. Throws InputError for the file, UrdfOptionError for the options.
Model load_urdf(const std::string& path, const UrdfOptions& options = {});

}  // namespace manycontact
