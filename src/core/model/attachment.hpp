#pragma once

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Returns why an attachment is on no body of the scene, or "" if it is on one.
std::string problem(const Scene& scene, const Attachment& at);
/// Describes an attachment on a robot: "frame 'hand' of robot 'r'".
std::string describe(const Scene& scene, const Attachment& at);

}  // namespace manycontact
