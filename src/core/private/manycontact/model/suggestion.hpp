#pragma once
// Texts of messages about unknown names, for files and for functions.

#include <string>
#include <string_view>
#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact {

std::string quote(std::string_view text);  // shortened if long

/// Returns "expected one of 'a', 'b', 'c'" if few names are known, else "did you mean 'x'?" with the most similar name.
std::string suggestion(const std::string& name, const std::vector<std::string>& known);

/// Return the text of an error about a name that no robot, frame of a robot, or movable joint has, with a suggestion
/// or, for a joint that is fixed or locked, the reason.
std::string no_robot(const Scene& scene, const std::string& name);
std::string no_frame(const std::string& robot, const Model& model, const std::string& name);
std::string no_joint(const Model& model, const std::string& name);

/// Return the number of the robot, or of the contact, of that name. They throw std::invalid_argument with a suggestion
/// if there is none. contact_at returns `number`, and throws with the name of `function` if there is no such contact.
int robot_called(const Scene& scene, const std::string& name);
int contact_called(const Scene& scene, const std::string& name);
int contact_at(const Scene& scene, int number, const char* function);

}  // namespace manycontact
