#include "scene_identity.hpp"

#include <cstring>

namespace manycontact {

SceneIdentity::SceneIdentity(const Scene& scene) {
  models_.reserve(scene.robots.size());
  contacts_.reserve(scene.contacts.size());
  for (const Robot& robot : scene.robots) models_.push_back(robot.model);
  for (const Contact& c : scene.contacts)
    contacts_.push_back({c.type, c.A.robot, c.A.joint, c.B.robot, c.B.joint, c.A.placement, c.axis});
  for (const ExternalWrench& push : scene.wrenches) wrenches_.push_back({push.at.robot, push.at.joint});
  for (const Spring& spring : scene.springs)
    for (const Attachment* end : {&spring.A, &spring.B}) springs_.push_back({end->robot, end->joint});
  for (const JointSpring& spring : scene.joint_springs) joint_springs_.push_back({spring.robot, spring.joint});
}

namespace {

template <class Matrix>
bool differ(const Matrix& x, const Matrix& y) {  // whether any bit differs, so that NaN equals itself
  return std::memcmp(x.data(), y.data(), sizeof(double) * x.size()) != 0;
}

std::string counts(const char* what, std::size_t was, std::size_t is) {
  return "the data were made for " + std::to_string(was) + " " + what + ", the scene has " + std::to_string(is);
}

}  // namespace

// Returns the name of a property that changed though it must not while data are in use (data.hpp); nullptr if none.
const char* SceneIdentity::changed(const OfContact& was, const Contact& is) {
  if (was.type != is.type) return "type";
  if (was.robot_A != is.A.robot || was.joint_A != is.A.joint) return "body A";
  if (was.robot_B != is.B.robot || was.joint_B != is.B.joint) return "body B";
  if (differ(was.place.p, is.A.placement.p) || differ(was.place.R, is.A.placement.R)) return "placement on A";
  return differ(was.axis, is.axis) ? "axis" : nullptr;
}

std::string SceneIdentity::difference_of_counts(const Scene& scene) const {
  if (models_.size() != scene.robots.size()) return counts("robots", models_.size(), scene.robots.size());
  if (contacts_.size() != scene.contacts.size()) return counts("contacts", contacts_.size(), scene.contacts.size());
  return "";
}
std::string SceneIdentity::difference_of_robot(const Scene& scene, std::size_t r) const {
  return models_[r] == scene.robots[r].model ? "" : "robot '" + scene.robots[r].name + "' has another model";
}
std::string SceneIdentity::difference_of_contact(const Scene& scene, std::size_t c) const {
  const char* what = changed(contacts_[c], scene.contacts[c]);
  return what ? "contact '" + scene.contacts[c].name + "' has another " + what : "";
}

std::string SceneIdentity::difference(const Scene& scene, const Island& island) const {
  std::string out = difference_of_counts(scene);
  for (std::size_t k = 0; out.empty() && k < island.robots.size(); ++k)
    out = difference_of_robot(scene, island.robots[k]);
  for (std::size_t k = 0; out.empty() && k < island.contacts.size(); ++k)
    out = difference_of_contact(scene, island.contacts[k]);
  return out;
}

std::string SceneIdentity::difference(const Scene& scene) const {
  std::string out = difference_of_counts(scene);
  for (std::size_t r = 0; out.empty() && r < models_.size(); ++r) out = difference_of_robot(scene, r);
  for (std::size_t c = 0; out.empty() && c < contacts_.size(); ++c) out = difference_of_contact(scene, c);
  if (!out.empty()) return out;
  return has_applied_forces(scene) ? difference_of_forces(scene) : "";  // wrenches and springs may all be removed
}

std::string SceneIdentity::difference_of_forces(const Scene& scene) const {
  if (wrenches_.size() != scene.wrenches.size()) return counts("wrenches", wrenches_.size(), scene.wrenches.size());
  if (springs_.size() != 2 * scene.springs.size()) return counts("springs", springs_.size() / 2, scene.springs.size());
  if (joint_springs_.size() != scene.joint_springs.size())
    return counts("springs in joints", joint_springs_.size(), scene.joint_springs.size());
  for (std::size_t k = 0; k < wrenches_.size(); ++k)
    if (!wrenches_[k].is(scene.wrenches[k].at)) return "wrench '" + scene.wrenches[k].name + "' is on another body";
  for (std::size_t k = 0; k < scene.springs.size(); ++k)
    if (!springs_[2 * k].is(scene.springs[k].A) || !springs_[2 * k + 1].is(scene.springs[k].B))
      return "spring '" + scene.springs[k].name + "' is on other bodies";
  for (std::size_t k = 0; k < joint_springs_.size(); ++k)
    if (scene.joint_springs[k].robot != joint_springs_[k].robot ||
        scene.joint_springs[k].joint != joint_springs_[k].joint)
      return "spring " + std::to_string(k) + " in a joint is in another joint";
  return "";
}

}  // namespace manycontact
