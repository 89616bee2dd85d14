#pragma once
// Names of robots, bodies, contacts and their rows in readable text.

#include <string>
#include <vector>

#include "manycontact/detail/kkt/island.hpp"

namespace manycontact {

struct Body {  // The body of an attachment. Everything that cannot move is the world, {-1, -1}.
  int robot = -1, joint = -1;
  auto operator<=>(const Body&) const = default;
};
Body body_of(const Attachment& attachment);

/// Returns a name for attachments on one body: the frame that all were made from ("humanoid/left_sole"). If their
/// frames differ or are unknown, the name is "world" for a fixed body. For other bodies it is the frame nearest to the
/// mean of the origins, or the body's joint. Throws std::invalid_argument if there is no attachment.
std::string place_name(const Scene& scene, const std::vector<const Attachment*>& on_body);

/// Returns at most four robot names ("a, beam"). Over three consecutive ones of one model become "ring0 .. ring15".
std::string robot_names(const Scene& scene, const std::vector<int>& robots);

/// Returns at most four contact names ("left, right"). More than three consecutive ones become "left_1 .. left_4".
std::string contact_names(const Scene& scene, const std::vector<int>& contacts);

std::string row_name(const Contact& contact, int row);  // returns the name of a contact row, such as "left[2]"

}  // namespace manycontact
