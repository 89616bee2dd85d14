#pragma once
// Names of robots and islands in readable output, copies combined.

#include "manycontact/dynamics/views.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

/// Returns "humanoid", or "herd x64" for copies.
std::string group_name(const RobotGroup& group);
/// Returns the counts of joint types: "1 floating, 32 revolute".
std::string joint_types(const Model& model);
/// Returns the names of robots, all copies of a group as one: "a, b, beam", "ring x16".
std::string robot_names(const SceneFile& file, const std::vector<int>& robots);
/// Returns the names of the robots of several islands, as robot_names does: "herd0 .. herd63".
std::string islands_name(const SceneFile& file, const std::vector<const Island*>& islands);

/// Returns for each contact of the scene the index of its ContactGroup in file.contact_groups.
std::vector<int> group_of_contacts(const SceneFile& file);

/// Counts the scene's islands, also for method dense-schur, whose report has one entry for all islands.
std::size_t count_islands(const Scene& scene, const SceneData& data);

/// Prints the heading of `solve` and `inspect`: name, path, gravity, damping, sizes.
void print_heading(std::ostream& out, const SceneFile& file, const SceneData& data);
/// Prints, by robot, the links that were merged or locked when the files were read.
void print_notes(std::ostream& out, const SceneFile& file);
/// Prints external wrenches and springs at the file's q and v: points, lengths and forces. May print nothing.
void print_applied_forces(std::ostream& out, const SceneFile& file);

}  // namespace manycontact::cli
