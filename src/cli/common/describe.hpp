#pragma once
// How robots, islands, bodies and contacts are called in readable output.

#include "manycontact/dynamics/data.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

/// "humanoid", or "herd x64" for copies.
std::string group_name(const RobotGroup& group);
/// "1 floating, 32 revolute".
std::string joint_types(const Model& model);
/// The robots, all copies of a group as one: "a, b, beam", "ring x16".
std::string robot_names(const SceneFile& file, const std::vector<int>& robots);
/// The same for several islands: "herd0 .. herd63".
std::string islands_name(const SceneFile& file, const std::vector<const Island*>& islands);

/// What a contact is attached to; anything that cannot move is the world.
struct Body {
  int robot = -1, joint = -1;
  auto operator<=>(const Body&) const = default;
};
Body body_of(const Attachment& attachment);
/// "humanoid/left_sole": of the body's frames the one nearest to `point` (in the joint's frame), or "world".
std::string frame_name(const Scene& scene, const Body& body, const Vec3<double>& point);

/// "left_1 .. left_4" or "left, right": as short as it stays clear.
std::string contact_names(const Scene& scene, const std::vector<int>& contacts);

/// Heading of both commands: name, path, gravity, damping, sizes.
void print_heading(std::ostream& out, const SceneFile& file, const SceneData& data);
/// What reading the files merged, locked or did not model, by robot; only the mimic joints unless `all`.
void print_notes(std::ostream& out, const SceneFile& file, bool all);

}  // namespace manycontact::cli
