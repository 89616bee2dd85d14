#pragma once

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Returns why an attachment is on none of the scene's bodies, or "".
std::string problem(const Scene& scene, const Attachment& at);
/// "frame 'hand' of robot 'r'", for an attachment on a robot.
std::string describe(const Scene& scene, const Attachment& at);

}  // namespace manycontact
