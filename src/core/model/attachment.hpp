#pragma once

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Returns why an attachment is on no body of the scene, or "" if it is on one.
std::string problem(const Scene& scene, const Attachment& at);
std::string describe(const Scene& scene, const Attachment& at);  // e.g. "frame 'hand' of robot 'r'"

}  // namespace manycontact
