#include "manycontact/model/scene.hpp"

#include <cmath>
#include <stdexcept>

namespace manycontact {

int add_robot(Scene& scene, const std::string& name, std::shared_ptr<const Model> model, const SE3<double>& base) {
  if (!model) throw std::invalid_argument("add_robot: '" + name + "' has no model");
  if (!scene.robot_index.emplace(name, scene.nrobots()).second)
    throw std::invalid_argument("add_robot: a robot named '" + name + "' exists already");
  Robot robot{name, std::move(model), base, scene.nq, scene.nv, scene.nu};
  scene.nq += robot.model->nq;
  scene.nv += robot.model->nv;
  scene.nu += robot.model->nu();
  scene.robots.push_back(std::move(robot));
  return scene.nrobots() - 1;
}

Attachment attach(const Scene& scene, const std::string& robot, const std::string& frame, const SE3<double>& offset) {
  const auto found = scene.robot_index.find(robot);
  if (found == scene.robot_index.end()) throw std::invalid_argument("attach: no robot named '" + robot + "'");
  const Model& model = *scene.robots[found->second].model;
  const int f = model.find_frame(frame);
  if (f < 0) throw std::invalid_argument("attach: robot '" + robot + "' has no frame '" + frame + "'");
  return {found->second, model.frames[f].joint, model.frames[f].placement * offset, frame};
}

namespace {

void check_attachment(const Scene& scene, const Attachment& a, const std::string& contact) {
  if (a.robot < -1 || a.robot >= scene.nrobots())
    throw std::invalid_argument("add_contact: '" + contact + "' names robot " + std::to_string(a.robot) + " of " +
                                std::to_string(scene.nrobots()));
  const int njoints = a.robot < 0 ? 0 : scene.robots[a.robot].model->njoints();
  if (a.joint < -1 || a.joint >= njoints)
    throw std::invalid_argument("add_contact: '" + contact + "' names joint " + std::to_string(a.joint) + " of " +
                                std::to_string(njoints));
  if (a.robot >= 0 && a.joint < 0 && scene.robots[a.robot].model->floating_base)
    throw std::invalid_argument("add_contact: '" + contact + "' names the fixed base of '" +
                                scene.robots[a.robot].name + "', which has a floating one");
  if (!a.placement.R.allFinite() || !a.placement.p.allFinite())
    throw std::invalid_argument("add_contact: '" + contact + "' has a placement that is not finite");
}

}  // namespace

int add_contact(Scene& scene, Contact contact) {
  check_attachment(scene, contact.A, contact.name);
  check_attachment(scene, contact.B, contact.name);
  if (contact.A.robot < 0)
    throw std::invalid_argument("add_contact: '" + contact.name + "' must have frame A on a robot");
  if (contact.A.robot == contact.B.robot && contact.A.joint == contact.B.joint)
    throw std::invalid_argument("add_contact: '" + contact.name + "' ties a body to itself");
  if (!std::isfinite(contact.alpha) || !std::isfinite(contact.beta))
    throw std::invalid_argument("add_contact: '" + contact.name + "' has gains that are not finite");
  const double norm = contact.axis.norm();
  if (!(norm > 0) || !std::isfinite(norm))
    throw std::invalid_argument("add_contact: '" + contact.name + "' needs an axis that is not zero");
  contact.axis /= norm;
  if (!scene.contact_index.emplace(contact.name, static_cast<int>(scene.contacts.size())).second)
    throw std::invalid_argument("add_contact: a contact named '" + contact.name + "' exists already");
  scene.contacts.push_back(std::move(contact));
  return static_cast<int>(scene.contacts.size()) - 1;
}

std::vector<std::string> velocity_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const Robot& r : scene.robots)
    for (int i = 0; i < r.model->nv; ++i) names.push_back(r.name + "/" + dof_name(*r.model, i));
  return names;
}

}  // namespace manycontact
