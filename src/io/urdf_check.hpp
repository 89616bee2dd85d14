#pragma once
// What urdfdom does not see or say of a URDF: lines, bad numbers, links that do not form a tree, limits as real files
// have them, what is left out. (It ignores, for one, that a link's <inertial> could not be read, and goes on with
// zeros.)

#include <limits>
#include <string>
#include <unordered_map>
#include <vector>

#include "manycontact/io/finding.hpp"
#include "xml.hpp"

namespace manycontact::io {

/// Of a joint: its line, and what urdfdom refuses where it is infinite or half there.
struct UrdfJoint {
  int line = 1;
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity(), effort = std::numeric_limits<double>::infinity();
  double damping = 0, friction = 0;  // of joints with one coordinate
};

struct UrdfDetails {
  int robot = 1;                              // line
  std::unordered_map<std::string, int> link;  // lines
  std::unordered_map<std::string, UrdfJoint> joint;
  std::vector<Finding> findings;  // odd but usable, and how it is taken
};

/// Throws InputError unless links and joints form one tree of numbers that something can be computed from.
UrdfDetails check_urdf(const Element& robot);

/// The file's text reduced to what urdfdom has to read (no limits, no shapes, no materials, no plug-ins), with zeros
/// for the numbers of inertias that are missing: what is left out cannot make it fail. Changes the document.
std::string text_for_urdfdom(XmlFile& file);

/// Refuses elements of xacro, except in shapes and colours: those are told (tell_unread).
void refuse_xacro(const Element& robot);

/// Elements and attributes that act on the motion and are not read: loops, gears, springs, what is misspelt.
void tell_unread(const Element& robot, std::vector<Finding>& findings);

}  // namespace manycontact::io
