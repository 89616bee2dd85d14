#pragma once
// Checks of an attachment, and its name in messages.

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Why an attachment is none of the scene's bodies; empty when it is one.
std::string problem(const Scene& scene, const Attachment& at);
/// "frame 'hand' of robot 'r'"; of an attachment on a robot.
std::string describe(const Scene& scene, const Attachment& at);

}  // namespace manycontact
