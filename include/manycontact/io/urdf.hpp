#pragma once
// A robot from a URDF file.
//
// Fixed joints are merged into the parent's body, so are locked ones; every link stays usable as a frame.
// Joints are numbered depth first from the root, those of a link in byte order of their names. Masses and
// inertias are judged per moving body, after merging. With a fixed base the bodies merged into the root link
// are immovable and dropped.
//
// What is odd but usable is taken, and told as findings: principal moments that no body has; limits that are infinite,
// negative, crossed or missing, which bound nothing; numbers that an inertia lacks, which are 0; elements that act on
// the motion and are not read.

#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "manycontact/io/finding.hpp"
#include "manycontact/model/model.hpp"

namespace manycontact {

struct UrdfOptions {           // What is said of a robot beside its file.
  bool floating_base = false;  // joint 0 is then "root", of type kFloating, carrying the root link
  double armature = 0;         // of every coordinate but the floating base's, kg m^2 (kg for prismatic)
  std::map<std::string, std::vector<double>> joint_armature = {};  // overrides it; one number, or one per coordinate
  std::map<std::string, double> locked = {};                       // joint frozen at this position; one-dof joints only
  bool refuse_mimic = false;                                       // a moving joint with <mimic> is an InputError
  std::set<std::string> passive = {};                              // joints without torques: Joint::actuated is false
  bool model_dynamics = false;          // <dynamics>: fills Model::damping and friction; else only noted
  bool refuse_inertia = false;          // principal moments that no body has are an InputError; else only noted
  std::set<std::string> actuated = {};  // floating joints of the file with torques in u: they are passive by default
  std::map<std::string, double> joint_damping = {};  // overrides <dynamics>; joints of one coordinate only
  /// The link that is the root instead of the file's: with a floating base that which "root" carries, with a fixed base
  /// that which stands in the world. Empty: the file's. A joint between the two is passed backwards, its child carries
  /// its parent: about -axis, so that q, v, torques and limits keep their meaning.
  std::string root = {};

  bool operator==(const UrdfOptions&) const = default;
};

/// The options do not fit the robot: `joint` is unknown, fixed, has several coordinates, ...
struct UrdfOptionError : std::invalid_argument {
  UrdfOptionError(std::string joint_, bool lock_, const std::string& message)
      : std::invalid_argument(message), joint(std::move(joint_)), lock(lock_) {}  // message: what is wrong
  std::string joint;
  bool lock;  // from UrdfOptions::locked, else from another
};

/// Reads and finalizes. Limits are infinite where the file has none that bound anything; a lower or upper that <limit>
/// leaves out is 0, as URDF has it. Throws InputError for the file, where nothing can be computed from it (no tree,
/// no numbers, negative masses or moments after merging), UrdfOptionError for the options.
/// findings, unless null: gets what is odd, by line.
Model load_urdf(const std::string& path, const UrdfOptions& options = {}, std::vector<Finding>* findings = nullptr);

}  // namespace manycontact
