#pragma once
// The parts of the viewer's HTML page, which the build embeds in the program, and the data that the page shows.

#include <string>
#include <string_view>

#include "../files/json_file.hpp"
#include "view.hpp"

namespace manycontact::cli {

struct PageParts {
  std::string_view html, css, script, three;  // three: three.js, empty if it was missing at build time
};
PageParts page_parts();
/// Throws std::runtime_error with the package to install if a part is missing.
void check_page_parts();

/// Returns the bytes in base64, as the page's `decode` reads them: little endian.
template <class T>
std::string base64_of(const std::vector<T>& list);

/// Returns the robots, their bodies' shapes and the meshes. Lists missing files in `notes`, mesh files in `read`.
Json shapes_of(const SceneFile& file, std::vector<std::string>& notes, std::vector<std::string>& read);

/// Records the last state of the motion as a frame, unless it is recorded already.
void finish(Recording& recording);

}  // namespace manycontact::cli
