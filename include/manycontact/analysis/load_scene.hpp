#pragma once
#include "manycontact/io/scene_file.hpp"

namespace manycontact {

struct TaskFile;  // io/task_file.hpp

/// Reads a scene file with read_scene, computes q and v with fit_state, and computes the torques of robots with
/// u="gravity" with quasi_static (dynamics/quasi_static.hpp) at that q. Adds a finding of kind "rest" for a robot that
/// no torques keep at rest. The file is not needed afterwards. Throws InputError. Thread-safe.
SceneFile load_scene(const std::string& path);
/// Loads a scene as load_scene does, from XML text instead of a file (see read_scene_text).
SceneFile load_scene_text(const std::string& text, const std::string& path);

/// Computes the q of the poses in a scene file (analysis/place.hpp), then consistent q and v (analysis/consistent.hpp),
/// if the file requests them. The scene must come from read_scene. Throws InputError.
void fit_state(SceneFile& file);
/// Computes q and v of the scene of a task read by read_task, and the references given as poses. The search for a
/// reference starts from the scene's q, and keeps contacts in place whose placement is known at the task's start.
void fit_state(TaskFile& task);

}  // namespace manycontact
