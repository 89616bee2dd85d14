#pragma once
#include "manycontact/io/scene_file.hpp"

namespace manycontact {

struct TaskFile;  // io/task_file.hpp

/// read_scene; q and v by fit_state; and the torques of robots with u="gravity" by quasi_static
/// (dynamics/quasi_static.hpp) at that q. Throws InputError.
SceneFile load_scene(const std::string& path);
/// The same of read_scene_text.
SceneFile load_scene_text(const std::string& text, const std::string& path);

/// Where the file asks for them, the q of its poses (analysis/place.hpp), then consistent q, v
/// (analysis/consistent.hpp). Throws InputError. For scenes that read_scene has read.
void fit_state(SceneFile& file);
/// The same for the scene of a task that read_task has read, and the references that are poses: postures found from the
/// scene's q that meet them, and hold the contacts that the scene or the start of the task has put in their places.
void fit_state(TaskFile& task);

}  // namespace manycontact
