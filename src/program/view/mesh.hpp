#pragma once
// Triangle meshes of a URDF's visuals.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace manycontact::cli {

struct Mesh {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Loads the triangles of an STL or OBJ file, in its own unit, or of a COLLADA file, in metres, each with three own
/// vertices. manycontact-mesh (mesh_main.cpp) reads it, since assimp may crash. Throws InputError, also without that
/// program.
Mesh load_mesh(const std::string& path);

/// Returns the mesh with at most so many triangles: merges the vertices in each cell of a grid, and leaves out
/// triangles that degenerate. The grid is as fine as the count allows. Source: Rossignac and Borrel, Multi-resolution
/// 3D approximations for rendering complex scenes, 1993.
Mesh decimate(const Mesh& mesh, std::size_t most_triangles);

}  // namespace manycontact::cli
