#pragma once
// Names of robots, bodies, contacts and their rows in readable text.

#include <string>
#include <vector>

#include "manycontact/detail/kkt/island.hpp"

namespace manycontact {

/// The body of an attachment; anything that cannot move is the world, {-1, -1}.
struct Body {
  int robot = -1, joint = -1;
  auto operator<=>(const Body&) const = default;
};
Body body_of(const Attachment& attachment);

/// Returns a name for attachments on one body: the frame that all were made from ("humanoid/left_sole"). If their
/// frames differ or are unknown: "world" for an immovable body, otherwise the body's frame nearest to the mean of the
/// origins, or the body's joint. Throws std::invalid_argument if there is no attachment.
std::string place_name(const Scene& scene, const std::vector<const Attachment*>& on_body);

/// Returns "a, b, beam", at most four names; more than three neighbours with one model are "ring0 .. ring15".
std::string robot_names(const Scene& scene, const std::vector<int>& robots);

/// Returns "left, right", at most four names; more than three neighbours in the scene are "left_1 .. left_4".
std::string contact_names(const Scene& scene, const std::vector<int>& contacts);

/// Returns a row's name: "left[2]".
std::string row_name(const Contact& contact, int row);

}  // namespace manycontact
