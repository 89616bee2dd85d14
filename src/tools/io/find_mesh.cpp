#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "manycontact/io/visuals.hpp"

namespace manycontact {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

// Returns the folders that may contain ROS packages: those above the URDF file, and those of ROS_PACKAGE_PATH.
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

}  // namespace

std::string find_mesh(const std::string& urdf, const std::string& name) {
  const std::string package = "package://", file = "file://";
  fs::path path = fs::path(urdf).parent_path() / name;
  if (name.starts_with(file)) path = name.substr(file.size());
  if (!name.starts_with(package)) return is_file(path) ? path.string() : "";

  const fs::path inside = fs::path(name.substr(package.size())).relative_path();  // some files have package:///
  const fs::path rest = inside.lexically_relative(*inside.begin());
  for (const fs::path& folder : package_folders(urdf)) {
    if (is_file(folder / inside)) return (folder / inside).string();
    if (folder.filename() == *inside.begin() && is_file(folder / rest)) return (folder / rest).string();
  }
  return "";
}

}  // namespace manycontact
