#pragma once
// Reads a robot from a URDF file. Fixed and locked joints are merged into the parent's body; every link remains
// available as a frame. Joints are numbered depth first from the root, and by byte order of names below one link.
// Masses and inertias are checked per merged body. Bodies merged into a fixed root link are left out.
//
// Questionable but usable input is accepted and reported as findings:
//
// - principal moments that violate the triangle inequality
// - limits that are infinite, negative, crossed or missing; they are ignored
// - missing numbers of an inertia, which become 0
// - elements that influence the motion and are ignored

#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "manycontact/io/finding.hpp"
#include "manycontact/model/model.hpp"

namespace manycontact {

struct UrdfOptions {           // Properties of a robot that are not in its file.
  bool floating_base = false;  // joint 0 is then "root", of type kFloating, and moves the root link
  double armature = 0;         // armature of all coordinates except those of the floating base, kg m^2 (prismatic: kg)
  /// overrides armature; one number, or one per coordinate
  std::map<std::string, std::vector<double>> joint_armature = {};
  /// joints frozen at this position [rad, m]; joints with one coordinate only
  std::map<std::string, double> locked = {};
  bool refuse_mimic = false;           // a moving joint with <mimic> is an InputError
  std::set<std::string> passive = {};  // joints without torques: Joint::actuated is false
  bool model_dynamics = false;  // whether <dynamics> sets Model::damping and friction; false: it is only a finding
  bool refuse_inertia = false;  // principal moments that violate the triangle inequality are an InputError;
                                // false: they are only a finding
  std::set<std::string> actuated = {};  // floating joints of the file with torques in u; by default they have none
  std::map<std::string, double> joint_damping = {};  // overrides <dynamics>; joints with one coordinate only
  /// If not empty, the link that replaces the file's root: it is moved by the floating base, or fixed to the world.
  /// Joints between both roots are inverted, with a negated axis, so that q, v, torques and limits keep their meaning.
  std::string root = {};

  bool operator==(const UrdfOptions&) const = default;
};

/// Thrown if the options do not fit the robot, for example if `joint` is unknown or fixed.
struct UrdfOptionError : std::invalid_argument {
  /// Makes an error with what() == message.
  UrdfOptionError(std::string joint_, bool lock_, const std::string& message)
      : std::invalid_argument(message), joint(std::move(joint_)), lock(lock_) {}
  std::string joint;
  bool lock;  // whether the error is in UrdfOptions::locked
};

/// Reads and finalizes a model. Missing or ignored limits are infinite; a lower or upper bound that <limit> leaves out
/// is 0, as URDF defines. `findings`, unless null, receives questionable input, in the order of lines. Coordinates of q
/// have the order of the joints. Throws InputError if nothing can be computed from the file (no tree, no numbers,
/// negative masses or moments after merging), and UrdfOptionError. Thread-safe.
Model load_urdf(const std::string& path, const UrdfOptions& options = {}, std::vector<Finding>* findings = nullptr);

}  // namespace manycontact
