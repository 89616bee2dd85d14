#pragma once
// The page's parts, embedded when the program is built, and what is filled in.

#include <string>
#include <string_view>

#include "../files/json_file.hpp"
#include "view.hpp"

namespace manycontact::cli {

struct PageParts {
  std::string_view html, css, script, three;  // three.js, empty where it was not there to be embedded
};
PageParts page_parts();
/// Throws std::runtime_error with the package to install if a part is missing.
void check_page_parts();

/// The bytes in base64, as the page's `decode` reads them: little endian.
template <class T>
std::string base64_of(const std::vector<T>& list);

/// Returns the robots, the shapes of their bodies and the meshes. Missing files are listed in `notes`, the mesh files
/// that were read in `read`.
Json shapes_of(const SceneFile& file, std::vector<std::string>& notes, std::vector<std::string>& read);

/// Takes the last state.
void finish(Recording& recording);

}  // namespace manycontact::cli
