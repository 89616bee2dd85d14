#include "mesh.hpp"

#include <sys/wait.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "../command/execute.hpp"
#include "manycontact/io/input_error.hpp"

namespace manycontact::cli {

Mesh load_mesh(const std::string& path) {
  constexpr std::uintmax_t kLargest = std::uintmax_t(1) << 28;
  std::error_code error;
  if (const std::uintmax_t size = std::filesystem::file_size(path, error); !error && size > kLargest)
    throw InputError(path, 1, "is larger than 256 MB, expected a smaller mesh");
  const auto [out, status] = run_and_read({program_beside("manycontact-mesh"), path}, "", true);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 3) throw InputError(path, 1, out);
  if (WIFEXITED(status) && WEXITSTATUS(status) >= 126)
    throw InputError(path, 1,
                     "is not read, expected the program manycontact-mesh in the folder of this program: install "
                     "libassimp-dev (its name in Debian), then configure and build manycontact again");
  if (status != 0)
    throw InputError(path, 1, "cannot be read by assimp within 60 s and 4 GB, expected a smaller or correct mesh");

  Mesh mesh;
  mesh.vertices.resize(out.size() / sizeof mesh.vertices[0]);
  std::memcpy(mesh.vertices.data(), out.data(), mesh.vertices.size() * sizeof mesh.vertices[0]);
  for (std::uint32_t k = 0; k + 2 < mesh.vertices.size(); k += 3) mesh.triangles.push_back({k, k + 1, k + 2});
  if (mesh.triangles.empty()) throw InputError(path, 1, "has no triangles, expected at least one triangle");
  for (const auto& vertex : mesh.vertices)
    for (const float x : vertex)
      if (!std::isfinite(x)) throw InputError(path, 1, "has a vertex that is not finite, expected finite coordinates");
  return mesh;
}

}  // namespace manycontact::cli
