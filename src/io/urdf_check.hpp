#pragma once
// What urdfdom does not see or say of a URDF: lines, bad numbers, links that do not form a tree. (It ignores,
// for one, that a link's <inertial> could not be read, and goes on with zeros.)

#include <string>
#include <unordered_map>

#include "xml.hpp"

namespace manycontact::io {

/// Where links and joints stand in the file.
struct UrdfLines {
  int robot = 1;
  std::unordered_map<std::string, int> link, joint;
};

/// Throws InputError unless links and joints are complete and form one tree.
UrdfLines check_urdf(const Element& robot);

/// The file's text reduced to what the dynamics needs (no shapes, no materials, no plug-ins), for urdfdom:
/// what is left out cannot make it fail. Changes the document.
std::string text_for_urdfdom(XmlFile& file);

}  // namespace manycontact::io
