#pragma once
// Triangle meshes that a URDF draws.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace manycontact::cli {

struct Mesh {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// STL and OBJ, in the file's own unit, and COLLADA, in metres: the triangles, each with three vertices of its own.
/// They come from manycontact-mesh (mesh_main.cpp), which a malicious file may crash. Throws InputError, also where
/// that program is not there.
Mesh load_mesh(const std::string& path);

/// The mesh with at most so many triangles: vertices in one cell of a grid become one, and triangles that this makes
/// degenerate are left out; the grid is as fine as the count allows. Also joins corners that are equal.
/// Source: Rossignac and Borrel, Multi-resolution 3D approximations for rendering complex scenes, 1993.
Mesh decimate(const Mesh& mesh, std::size_t most_triangles);

}  // namespace manycontact::cli
