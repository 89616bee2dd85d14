#pragma once
#include "mesh.hpp"

namespace manycontact::cli {

/// The mesh with at most so many triangles: vertices in one cell of a grid become one, and triangles that this makes
/// degenerate are left out; the grid is as fine as the count allows. Also joins corners that are equal.
/// Source: Rossignac and Borrel, Multi-resolution 3D approximations for rendering complex scenes, 1993.
Mesh decimate(const Mesh& mesh, std::size_t most_triangles);

}  // namespace manycontact::cli
