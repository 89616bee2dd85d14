#include "scene_parts.hpp"

namespace manycontact::io {
namespace {

// Reads three numbers, from the attribute `together` (such as xyz) or from one attribute each (such as x, y, z).
void read_three(const Element& e, const char* together, const std::array<const char*, 3>& apart,
                const std::array<std::optional<double>*, 3>& out) {
  const auto all = e.numbers<3>(together);
  for (std::size_t k = 0; k < 3; ++k) {
    if (all) *out[k] = (*all)[k];
    if (!e.has(apart[k])) continue;
    if (all) e.refuse(apart[k], std::string(" is given with ") + together + ", expected only one of the two");
    *out[k] = e.required_number(apart[k]);
  }
}

// Reads the robot, or the copies of a robot, whose centre of mass a <pose> element prescribes.
End read_center(const Element& e, EndReader& ends) {
  for (const char* a : {"frame", "offset", "rpy", "roll", "pitch", "yaw"})
    if (e.has(a)) e.refuse(a, " is given with com, expected only x, y, z of the centre of mass");
  return ends.robot(e, "com", e.required("com"));
}

End read_frame(const Element& e, EndReader& ends) {
  const End end = ends.read_first(e, "frame");
  if (end.frame.joint < 0)
    e.where("frame").fail("frame of <pose> is " + quote(e.required("frame")) +
                          ", which cannot move, expected a frame that moves");
  return end;
}

}  // namespace

void read_pose(const Element& e, const Scene& scene, EndReader& ends, std::vector<ScenePose>& out) {
  e.allow({"frame", "com", "offset", "xyz", "rpy", "x", "y", "z", "roll", "pitch", "yaw"});
  ScenePose pose;
  pose.center_of_mass = e.has("com");
  const End end = pose.center_of_mass ? read_center(e, ends) : read_frame(e, ends);
  pose.file = *e.where().file;
  pose.line = e.line();
  read_three(e, "xyz", {"x", "y", "z"}, {&pose.x, &pose.y, &pose.z});
  read_three(e, "rpy", {"roll", "pitch", "yaw"}, {&pose.roll, &pose.pitch, &pose.yaw});
  if (!(pose.x || pose.y || pose.z || pose.roll || pose.pitch || pose.yaw))
    e.fail("<pose> of " + quote(e.required(pose.center_of_mass ? "com" : "frame")) +
           " gives no coordinate, expected xyz, rpy or any of x, y, z, roll, pitch, yaw");
  SE3<double> offset;
  (void)e.read("offset", offset.p);
  for (int i = 0; i < end.count; ++i) {
    const int robot = end.first + i;
    pose.name = scene.robots[robot].name + (pose.center_of_mass ? "" : "/" + end.frame.name);
    pose.frame = end.on(robot, offset);
    out.push_back(pose);
  }
}

void add_poses(const std::vector<Element>& elements, SceneFile& out) {
  EndReader ends(out);
  for (const Element& e : elements) read_pose(e, out.scene, ends, out.poses);
}

}  // namespace manycontact::io
