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

/// Return an error text about an unknown name, with a suggestion or the reason why a joint is fixed or locked.
std::string no_robot(const Scene& scene, const std::string& name);
std::string no_frame(const std::string& robot, const Model& model, const std::string& name);
std::string no_joint(const Model& model, const std::string& name);

/// Return a robot's or contact's number. They throw std::invalid_argument, with a suggestion or the name of `function`.
int robot_called(const Scene& scene, const std::string& name);
int contact_called(const Scene& scene, const std::string& name);
int contact_at(const Scene& scene, int number, const char* function);

}  // namespace manycontact
