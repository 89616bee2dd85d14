#include "scene_identity.hpp"

#include <cstring>

namespace manycontact {

SceneIdentity::SceneIdentity(const Scene& scene) {
  models_.reserve(scene.robots.size());
  contacts_.reserve(scene.contacts.size());
  for (const Robot& robot : scene.robots) models_.push_back(robot.model);
  for (const Contact& c : scene.contacts)
    contacts_.push_back({c.type, c.A.robot, c.A.joint, c.B.robot, c.B.joint, c.A.placement, c.axis});
}

namespace {

// Bit by bit: NaN is what it was.
template <class Matrix>
bool differ(const Matrix& x, const Matrix& y) {
  return std::memcmp(x.data(), y.data(), sizeof(double) * x.size()) != 0;
}

std::string counts(const char* what, std::size_t was, std::size_t is) {
  return "they were made for " + std::to_string(was) + " " + what + ", the scene has " + std::to_string(is);
}

}  // namespace

// What may not change under data in use (data.hpp), as `contact` was and is. Null: nothing did.
const char* SceneIdentity::changed(const OfContact& was, const Contact& is) {
  if (was.type != is.type) return "type";
  if (was.robot_A != is.A.robot || was.joint_A != is.A.joint) return "body A";
  if (was.robot_B != is.B.robot || was.joint_B != is.B.joint) return "body B";
  if (differ(was.place.p, is.A.placement.p) || differ(was.place.R, is.A.placement.R)) return "placement on A";
  return differ(was.axis, is.axis) ? "axis" : nullptr;
}

std::string SceneIdentity::difference(const Scene& scene) const {
  if (models_.size() != scene.robots.size()) return counts("robots", models_.size(), scene.robots.size());
  if (contacts_.size() != scene.contacts.size()) return counts("contacts", contacts_.size(), scene.contacts.size());
  for (std::size_t r = 0; r < models_.size(); ++r)
    if (models_[r] != scene.robots[r].model) return "robot '" + scene.robots[r].name + "' has another model";
  for (std::size_t c = 0; c < contacts_.size(); ++c)
    if (const char* what = changed(contacts_[c], scene.contacts[c]))
      return "contact '" + scene.contacts[c].name + "' has another " + what;
  return "";
}

}  // namespace manycontact
