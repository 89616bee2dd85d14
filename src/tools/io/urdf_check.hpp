#pragma once
// Checks that urdfdom does not make: lines, bad numbers, links that form no tree, unusual limits, and ignored elements.
// For example, urdfdom ignores an <inertial> that it could not read, and continues with zeros.

#include <limits>
#include <string>
#include <unordered_map>
#include <vector>

#include "manycontact/io/finding.hpp"
#include "manycontact/spatial/inertia.hpp"
#include "xml.hpp"

namespace manycontact::io {

/// A joint's line, and attributes that urdfdom refuses if they are infinite or incomplete.
struct UrdfJoint {
  int line = 1;
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity(), effort = std::numeric_limits<double>::infinity();
  double damping = 0, friction = 0;  // given for joints with one coordinate
};

struct UrdfDetails {
  int robot = 1;                              // line
  std::unordered_map<std::string, int> link;  // lines
  std::unordered_map<std::string, UrdfJoint> joint;
  std::vector<Finding> findings;  // odd but usable, and how it is taken
};

/// Throws InputError unless links and joints form one tree of numbers that something can be computed from.
UrdfDetails check_urdf(const Element& robot);

/// Returns the text of the file reduced to the elements that urdfdom has to read: no limits, shapes, materials and
/// plug-ins. Missing numbers of inertias are zeros, so that they cannot make it fail. Changes the document.
std::string text_for_urdfdom(XmlFile& file);

// Whether a moving body's inertia is one that something can be computed with, and one that a body can have.

/// Both return a description, or nothing if there is no fault. The text continues "link x and what is merged into it
/// have".
struct InertiaVerdict {
  std::string refused;  // not finite, a negative mass, a principal moment below -1e-9 of the trace
  std::string odd;      // principal moments that violate the triangle inequality; they are used as they are
};

/// Y: of the body with all that is merged into it, about any origin. Massless bodies are ideal ones: a rotor about one
/// axis is allowed. (What is merged first may be anything: Talos' gripper motors alone lack 1.3 % of their trace.)
InertiaVerdict judge_inertia(const Inertia<double>& Y);

/// Refuses elements of xacro, except in shapes and colours, which tell_unread reports.
void refuse_xacro(const Element& robot);

/// Elements and attributes that act on the motion and are not read: loops, gears, springs, what is misspelt.
void tell_unread(const Element& robot, std::vector<Finding>& findings);

}  // namespace manycontact::io
