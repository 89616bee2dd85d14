#pragma once
// How robots, bodies, contacts and their rows are called in readable text.

#include <string>
#include <vector>

#include "manycontact/kkt/island.hpp"

namespace manycontact {

/// What a contact is attached to; anything that cannot move is the world, {-1, -1}.
struct Body {
  int robot = -1, joint = -1;
  auto operator<=>(const Body&) const = default;
};
Body body_of(const Attachment& attachment);  // the body it is on

/// "humanoid/left_sole", or "world": where attachments on one body are. The frame by which all of them were attached,
/// a fixed base's too; where they differ or have none, "world" for what cannot move, else of the body's frames the one
/// nearest to the mean of their origins; a body without frames is called by its joint. Throws std::invalid_argument
/// when there is none.
std::string place_name(const Scene& scene, const std::vector<const Attachment*>& on_body);

/// "a, b, beam", at most four names; more than three neighbours in the scene that share a model are "ring0 .. ring15".
std::string robot_names(const Scene& scene, const std::vector<int>& robots);

/// "left, right", at most four names; more than three neighbours in the scene are "left_1 .. left_4".
std::string contact_names(const Scene& scene, const std::vector<int>& contacts);

/// "left[2]"
std::string row_name(const Contact& contact, int row);

}  // namespace manycontact
