#pragma once
// The visual shapes of a URDF's links. They serve for pictures only, and a Model does not contain them.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "manycontact/io/input_error.hpp"
#include "manycontact/spatial/se3.hpp"

namespace manycontact {

enum class VisualShape { kBox, kCylinder, kSphere, kMesh };

struct Visual {  // One shape of a link.
  std::string link;
  SE3<double> placement;  // placement in the link's frame
  VisualShape shape = VisualShape::kBox;
  Vec3<double> size;  // box: its edges; cylinder, along z: radius, length, 0; sphere: radius, 0, 0 [m]; mesh: scales
  std::string mesh;   // the file's name in the URDF; find_mesh finds the file
  std::optional<std::array<double, 4>> colour;  // red, green, blue, opacity, from 0 to 1
};

/// Loads all visuals in the order of the file. Shapes other than those of URDF 1.0 are skipped. Throws InputError.
std::vector<Visual> load_visuals(const std::string& urdf);

/// Finds the file that a URDF calls `name`; returns "" if there is none. Packages are searched in the URDF's folder,
/// the folders above it, and those of ROS_PACKAGE_PATH. "package://p/rest" is p/rest in such a folder, or `rest` if the
/// folder itself is called p. "file://" is an absolute path. Any other name is relative to the URDF.
std::string find_mesh(const std::string& urdf, const std::string& name);

}  // namespace manycontact
