#pragma once
// The links and joints of a URDF, checked: names, numbers, one tree; and what is unusual about them or is not read.

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manycontact/io/finding.hpp"
#include "manycontact/spatial/inertia.hpp"
#include "xml.hpp"

namespace manycontact::io {

struct UrdfJoint {
  enum Type { kRevolute, kPrismatic, kContinuous, kPlanar, kFixed, kFloating };
  int line = 1;
  Type type = kFixed;
  std::string name = {}, parent = {}, child = {};  // of links: parent, child
  SE3<double> placement = {};                      // of the child in the parent at q = 0
  Vec3<double> axis = Vec3<double>::UnitX();       // a unit vector
  std::optional<std::string> mimic = {};           // the other joint; of joints with one coordinate
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity(), effort = std::numeric_limits<double>::infinity();
  double damping = 0, friction = 0;  // given for joints with one coordinate
};

struct UrdfLink {
  int line = 1;
  std::optional<Inertia<double>> inertia = {};
  const UrdfJoint* above = nullptr;  // null: the root
  std::vector<const UrdfJoint*> below = {};
};

struct UrdfRobot {
  std::string name, root;  // root: a link
  int line = 1;
  std::map<std::string, UrdfLink> links;
  std::map<std::string, UrdfJoint> joints;
  std::vector<Finding> findings;  // odd but usable, and how it is taken
};

/// Throws InputError unless links and joints form one tree of numbers that something can be computed from.
UrdfRobot read_urdf(const Element& robot);

/// The placement of an <origin> child; the identity without one.
SE3<double> read_origin(const Element& parent);

/// Refuses elements of xacro, except in shapes and colours, which tell_unread reports.
void refuse_xacro(const Element& robot);

/// Elements and attributes that act on the motion and are not read: loops, gears, springs, what is misspelt.
void tell_unread(const Element& robot, std::vector<Finding>& findings);

}  // namespace manycontact::io
