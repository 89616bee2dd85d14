#pragma once
// Names of robots and islands for readable output, in which copies are combined.

#include "manycontact/dynamics/views.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

std::string group_name(const RobotGroup& group);  // such as "humanoid", or "herd x64" for copies
std::string joint_types(const Model& model);  // returns the counts of joint types, such as "1 floating, 32 revolute"
/// Returns names of robots such as "a, b, beam". All copies of a group have one name, such as "ring x16".
std::string robot_names(const SceneFile& file, const std::vector<int>& robots);
/// Returns the names of the robots of several islands as robot_names does, such as "herd0 .. herd63".
std::string islands_name(const SceneFile& file, const std::vector<const Island*>& islands);

/// Returns for each contact of the scene the index of its group in file.contact_groups.
std::vector<int> group_of_contacts(const SceneFile& file);

/// Returns the number of the scene's islands. With method dense-schur, the report has only one entry for all islands.
std::size_t count_islands(const Scene& scene, const SceneData& data);

/// Prints the heading of `solve` and `inspect`, which contains name, path, gravity, damping and sizes.
void print_heading(std::ostream& out, const SceneFile& file, const SceneData& data);
void print_notes(std::ostream& out, const SceneFile& file);  // prints links that were merged or locked, per robot
/// Prints points, lengths and forces of external wrenches and springs at the file's q and v, if there are any.
void print_applied_forces(std::ostream& out, const SceneFile& file);

}  // namespace manycontact::cli
