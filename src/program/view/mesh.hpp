#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace manycontact::cli {

struct Mesh {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Loads the triangles, with three vertices of their own, of an STL or OBJ file in its own unit, or of a COLLADA file
/// in metres. manycontact-mesh (mesh_main.cpp) reads the file, since a malicious one may crash assimp. Throws
/// InputError, also if that program is missing.
Mesh load_mesh(const std::string& path);

/// Returns the mesh with at most so many triangles: merges the vertices in each cell of a grid, and leaves out
/// triangles that degenerate. The grid is as fine as the count allows. Source: Rossignac and Borrel, Multi-resolution
/// 3D approximations for rendering complex scenes, 1993.
Mesh decimate(const Mesh& mesh, std::size_t most_triangles);

}  // namespace manycontact::cli
