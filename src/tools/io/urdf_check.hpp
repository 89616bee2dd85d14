#pragma once
// Checks of a URDF file that urdfdom omits: invalid numbers, links that form no tree, unusual limits, and ignored
// elements, each reported with its line. For example, urdfdom continues with zeros if it cannot read an <inertial>.

#include <limits>
#include <string>
#include <unordered_map>
#include <vector>

#include "manycontact/io/finding.hpp"
#include "manycontact/spatial/inertia.hpp"
#include "xml.hpp"

namespace manycontact::io {

struct UrdfJoint {  // the line of a joint, and attributes that urdfdom refuses if they are infinite or incomplete
  int line = 1;
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity(), effort = std::numeric_limits<double>::infinity();
  double damping = 0, friction = 0;  // only for joints with one coordinate
};

struct UrdfDetails {
  int robot = 1;                              // line of <robot>
  std::unordered_map<std::string, int> link;  // lines of links
  std::unordered_map<std::string, UrdfJoint> joint;
  std::vector<Finding> findings;  // unusual but usable input, with its interpretation
};

/// Checks a robot element of URDF. Throws InputError unless its links and joints form one tree with usable numbers.
UrdfDetails check_urdf(const Element& robot);

/// Returns the file's text reduced to the elements that urdfdom must read, without limits, shapes, materials and
/// plug-ins. Missing numbers of inertias become zeros, because urdfdom requires them. Modifies the document of `file`.
std::string text_for_urdfdom(XmlFile& file);

/// Problems of a moving body's inertia, each "" if there is none. A text continues "link x and the merged links have".
struct InertiaVerdict {
  std::string refused;  // unusable: not finite, a negative mass, a principal moment below -1e-9 of the trace
  std::string odd;      // principal moments that violate the triangle inequality; they are used as given
};

/// Checks the inertia Y, about any origin, of a body with all links merged into it. Massless bodies and rotors about
/// one axis are allowed. Merged links are not checked individually, because Talos' gripper motors would fail by 1.3 %.
InertiaVerdict judge_inertia(const Inertia<double>& Y);

/// Throws InputError for elements of xacro, except in shapes and colours, where tell_unread reports them.
void refuse_xacro(const Element& robot);

/// Reports ignored elements and attributes that affect the motion, such as loops, gears, springs and misspelt names.
void tell_unread(const Element& robot, std::vector<Finding>& findings);

}  // namespace manycontact::io
