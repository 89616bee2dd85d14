#pragma once
// Wording of messages about unknown names, in files and in code.

#include <string>
#include <string_view>
#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Returns 'text' in quotes, shortened if long.
std::string quote(std::string_view text);

/// Returns "expected one of 'a', 'b', 'c'" if few names are known, otherwise "did you mean 'x'?".
std::string suggestion(const std::string& name, const std::vector<std::string>& known);

/// Explain that no robot, frame of a robot, or movable joint has this name: its actual kind, or a suggestion.
std::string no_robot(const Scene& scene, const std::string& name);
std::string no_frame(const std::string& robot, const Model& model, const std::string& name);
std::string no_joint(const Model& model, const std::string& name);

/// Return the number of the robot or contact of that name. contact_at checks `number` and returns it. They throw
/// std::invalid_argument with a suggestion, contact_at with the name of `function`.
int robot_called(const Scene& scene, const std::string& name);
int contact_called(const Scene& scene, const std::string& name);
int contact_at(const Scene& scene, int number, const char* function);

}  // namespace manycontact
