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

/// Loads the triangles of an STL or OBJ file in the file's unit, or of a COLLADA file in metres. Triangles
/// share no vertices. A separate program, manycontact-mesh (mesh_main.cpp), reads the file, because malicious files may
/// crash assimp. Throws InputError, also if manycontact-mesh is missing.
Mesh load_mesh(const std::string& path);

/// Returns a mesh of at most `most_triangles` triangles. Merges the vertices in each cell of a grid, which is as fine
/// as most_triangles allows, and removes degenerate triangles. Source: Rossignac and Borrel, Multi-resolution 3D
/// approximations for rendering complex scenes, 1993.
Mesh decimate(const Mesh& mesh, std::size_t most_triangles);

}  // namespace manycontact::cli
