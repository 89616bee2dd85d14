#pragma once
// The visual shapes of a URDF's links. They are for pictures alone: a Model does not contain them.

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

/// All visuals, in the order of the file. Shapes that URDF 1.0 does not have are left out. Throws InputError.
std::vector<Visual> load_visuals(const std::string& urdf);

/// The file that `urdf` means by `name`; empty where there is none. "package://p/rest": rest in a folder p among the
/// URDF's own folder, those above it, and those of ROS_PACKAGE_PATH, or in one of these called p itself. "file://": an
/// absolute path; anything else: relative to the URDF.
std::string find_mesh(const std::string& urdf, const std::string& name);

}  // namespace manycontact
