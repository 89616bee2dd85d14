#include <algorithm>
#include <set>
#include <unordered_map>

#include "mesh.hpp"

namespace manycontact::cli {

namespace {

using Point = std::array<float, 3>;

// Merges the vertices of each grid cell into the cell's first vertex, so that planes and edges keep their positions.
Mesh cluster(const Mesh& mesh, const Point& corner, float cell) {
  Mesh out;
  std::unordered_map<std::uint64_t, std::uint32_t> vertex_of_cell;
  std::vector<std::uint32_t> vertex;
  for (const Point& p : mesh.vertices) {
    std::uint64_t key = 0;
    for (std::size_t k = 0; k < 3; ++k)
      key = key << 21 | static_cast<std::uint64_t>(cell > 0 ? (p[k] - corner[k]) / cell + 0.5F : 0.F);
    const auto [at, is_new] = vertex_of_cell.emplace(key, static_cast<std::uint32_t>(out.vertices.size()));
    if (is_new) out.vertices.push_back(p);
    vertex.push_back(at->second);
  }
  std::set<std::array<std::uint32_t, 3>> seen;
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array<std::uint32_t, 3> triangle{vertex[a], vertex[b], vertex[c]};
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
    std::array<std::uint32_t, 3> sorted = triangle;
    std::ranges::sort(sorted);
    if (seen.insert(sorted).second) out.triangles.push_back(triangle);
  }
  return out;
}

}  // namespace

Mesh decimate(const Mesh& mesh, std::size_t most_triangles) {
  Point low = mesh.vertices.front(), high = low;
  for (const Point& p : mesh.vertices)
    for (std::size_t k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  const float size = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  for (int cells = 1 << 20;; cells = cells > 256 ? 256 : cells * 7 / 8) {
    Mesh out = cluster(mesh, low, size / static_cast<float>(cells));
    if (out.triangles.size() <= most_triangles || cells <= 8) return out;
  }
}

}  // namespace manycontact::cli
