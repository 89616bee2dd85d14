#include "manycontact/io/mesh.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "text.hpp"

namespace manycontact {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHeader = 80, kFacet = 50;  // bytes of binary STL: head, and per triangle

std::string extension(const std::string& path) {
  std::string ext = fs::path(path).extension().string();
  std::transform(ext.begin(), ext.end(), ext.begin(), [](unsigned char c) { return std::tolower(c); });
  return ext;
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

// Folders that packages may lie in.
std::vector<fs::path> package_folders(const std::string& urdf) {
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::path at = fs::absolute(urdf, error).lexically_normal().parent_path();; at = at.parent_path()) {
    folders.push_back(at);
    if (at == at.parent_path()) break;
  }
  const char* variable = std::getenv("ROS_PACKAGE_PATH");
  std::string list = variable ? variable : "";
  for (std::size_t from = 0; from < list.size();) {
    const std::size_t to = std::min(list.find(':', from), list.size());
    if (to > from) folders.emplace_back(list.substr(from, to - from));
    from = to + 1;
  }
  return folders;
}

void add_triangle(const std::array<std::array<float, 3>, 3>& corners, Mesh& mesh) {
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const auto& corner : corners) mesh.vertices.push_back(corner);
  mesh.triangles.push_back({n, n + 1, n + 2});
}

std::uint32_t little_endian(const char* bytes) {
  std::uint32_t x = 0;
  for (int k = 3; k >= 0; --k) x = x << 8 | static_cast<unsigned char>(bytes[k]);
  return x;
}

// Text STL starts with "solid", and so may a binary one: its size tells.
bool is_binary_stl(const std::string& bytes) {
  return bytes.size() >= kHeader + 4 &&
         bytes.size() == kHeader + 4 + kFacet * std::size_t{little_endian(bytes.data() + kHeader)};
}

Mesh binary_stl(const std::string& bytes) {
  Mesh mesh;
  for (std::size_t at = kHeader + 4; at < bytes.size(); at += kFacet) {
    std::array<std::array<float, 3>, 3> corners;
    for (std::size_t k = 0; k < 9; ++k)  // after the normal
      corners[k / 3][k % 3] = std::bit_cast<float>(little_endian(bytes.data() + at + 12 + 4 * k));
    add_triangle(corners, mesh);
  }
  return mesh;
}

// Calls take(line number, words) for each line that has words.
template <class Take>
void for_each_line(const std::string& text, const Take& take) {
  int number = 0;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    const auto words = io::words(std::string_view(text).substr(from, to - from));
    ++number;
    if (!words.empty()) take(number, words);
    from = to + 1;
  }
}

std::array<float, 3> vertex_of(const io::Where& where, const std::vector<std::string_view>& words) {
  if (words.size() < 4) where.fail("a vertex has fewer than three numbers, expected x y z");
  std::array<float, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = static_cast<float>(io::parse_number(where, "a vertex", words[k + 1]));
  return out;
}

Mesh text_stl(const std::string& path, const std::string& text) {
  Mesh mesh;
  std::vector<std::array<float, 3>> loop;
  for_each_line(text, [&](int line, const auto& words) {
    if (words[0] == "vertex") loop.push_back(vertex_of({&path, line}, words));
    if (words[0] != "endloop") return;
    if (loop.size() != 3) io::Where{&path, line}.fail("a facet has not three vertices, expected triangles");
    add_triangle({loop[0], loop[1], loop[2]}, mesh);
    loop.clear();
  });
  return mesh;
}

// "7", "7/1", "7/1/3", "7//3": the 7th vertex; negative: counted from the last one.
std::uint32_t corner_of(const io::Where& where, std::string_view word, std::size_t vertices) {
  long long k = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), k);
  const bool number = error == std::errc() && (end == word.data() + word.size() || *end == '/');
  const long long n = static_cast<long long>(vertices), at = k < 0 ? n + k : k - 1;
  if (!number || at < 0 || at >= n)
    where.fail("a face's corner " + quote(std::string(word)) + " is no vertex above it");
  return static_cast<std::uint32_t>(at);
}

Mesh obj(const std::string& path, const std::string& text) {
  Mesh mesh;
  for_each_line(text, [&](int line, const auto& words) {
    const io::Where where{&path, line};
    if (words[0] == "v") mesh.vertices.push_back(vertex_of(where, words));
    if (words[0] != "f") return;
    std::vector<std::uint32_t> corners;
    for (std::size_t k = 1; k < words.size(); ++k) corners.push_back(corner_of(where, words[k], mesh.vertices.size()));
    for (std::size_t k = 2; k < corners.size(); ++k) mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
  });
  return mesh;
}

}  // namespace

std::string find_mesh(const std::string& urdf, const std::string& name) {
  const std::string package = "package://", file = "file://";
  fs::path path = fs::path(urdf).parent_path() / name;
  if (name.starts_with(file)) path = name.substr(file.size());
  if (!name.starts_with(package)) return is_file(path) ? path.string() : "";

  const fs::path inside = name.substr(package.size());
  const fs::path rest = inside.lexically_relative(*inside.begin());
  for (const fs::path& folder : package_folders(urdf)) {
    if (is_file(folder / inside)) return (folder / inside).string();
    if (folder.filename() == *inside.begin() && is_file(folder / rest)) return (folder / rest).string();
  }
  return "";
}

bool is_mesh_format(const std::string& path) { return extension(path) == ".stl" || extension(path) == ".obj"; }

Mesh load_mesh(const std::string& path) {
  std::string problem = io::file_problem(path, true);  // a path from a URDF
  const std::string bytes = problem.empty() ? io::read_file(path, problem) : "";
  if (!problem.empty()) throw InputError(path, 1, problem + ", expected a mesh");
  if (!is_mesh_format(path)) throw InputError(path, 1, "is no mesh that can be read, expected .stl or .obj");
  const bool is_obj = extension(path) == ".obj";
  Mesh mesh = is_obj ? obj(path, bytes) : is_binary_stl(bytes) ? binary_stl(bytes) : text_stl(path, bytes);
  if (mesh.triangles.empty()) throw InputError(path, 1, "has no triangles, expected some");
  for (const auto& vertex : mesh.vertices)
    for (const float x : vertex)
      if (!std::isfinite(x)) throw InputError(path, 1, "has a vertex that is not finite, expected numbers");
  return mesh;
}

}  // namespace manycontact
