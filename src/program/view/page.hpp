#pragma once
// The parts of the viewer's HTML page, which the build embeds in the program, and the data that the page shows.

#include <string>
#include <string_view>

#include "../files/json_file.hpp"
#include "view.hpp"

namespace manycontact::cli {

struct PageParts {
  std::string_view html, css, script, three;  // three: three.js, or empty if it was missing at build time
};
PageParts page_parts();
void check_page_parts();  // Throws std::runtime_error if a part is missing. The message names the package to install.

/// Returns the little-endian bytes of a list in base64, as `decode` of the page reads them.
template <class T>
std::string base64_of(const std::vector<T>& list);

/// Returns the robots, the shapes of their bodies and the meshes. Adds missing files to `notes`, mesh files to `read`.
Json shapes_of(const SceneFile& file, std::vector<std::string>& notes, std::vector<std::string>& read);

void finish(Recording& recording);  // records the last state of the motion as a frame, unless it was recorded already

}  // namespace manycontact::cli
