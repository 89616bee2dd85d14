#pragma once
#include "manycontact/io/scene_file.hpp"

namespace manycontact {

/// read_scene; where it asks for them, consistent q, v (analysis/consistent.hpp); and the torques of robots with
/// u="gravity" by quasi_static (dynamics/quasi_static.hpp) at that q. Throws InputError.
SceneFile load_scene(const std::string& path);
/// The same of read_scene_text.
SceneFile load_scene_text(const std::string& text, const std::string& path);

}  // namespace manycontact
