#pragma once
// Triangle meshes that a URDF draws.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "manycontact/io/input_error.hpp"

namespace manycontact {

struct Mesh {                                  // Triangles of a file.
  std::vector<std::array<float, 3>> vertices;  // in the file's own unit
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The file that `urdf` means by `name`; empty where there is none. "package://p/rest": rest in a folder p among the
/// URDF's own folder, those above it, and those of ROS_PACKAGE_PATH, or in one of these called p itself. "file://": an
/// absolute path; anything else: relative to the URDF.
std::string find_mesh(const std::string& urdf, const std::string& name);

/// Whether load_mesh reads files of this name: .stl, .obj.
bool is_mesh_format(const std::string& path);

/// STL, binary or text, or OBJ, whose polygons become triangles; normals, textures and materials are left out. Equal
/// corners of an STL stay apart. Throws InputError.
Mesh load_mesh(const std::string& path);

}  // namespace manycontact
