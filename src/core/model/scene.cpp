#include "manycontact/model/scene.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "attachment.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact {

namespace {
bool is_finite(const SE3<double>& M) { return M.R.allFinite() && M.p.allFinite(); }
}  // namespace

int add_robot(Scene& scene, const std::string& name, std::shared_ptr<const Model> model, const SE3<double>& base) {
  const auto refuse = [&](const char* what) { throw std::invalid_argument("robot " + quote(name) + what); };
  if (!model) refuse(" has no model, expected a finalized model");
  if (!is_finalized(*model)) refuse(" has a model that was not finalized, expected finalize(model) before add_robot");
  if (!is_finite(base)) refuse(" has a base that is not finite, expected finite numbers");
  if (!scene.robot_index.emplace(name, scene.nrobots()).second) refuse(" exists already, expected names used once");
  Robot robot{name, std::move(model), base, scene.nq, scene.nv, scene.nu};
  scene.nq += robot.model->nq;
  scene.nv += robot.model->nv;
  scene.nu += robot.model->nu();
  scene.robots.push_back(std::move(robot));
  return scene.nrobots() - 1;
}

Attachment attach(const Scene& scene, const std::string& robot, const std::string& frame, const SE3<double>& offset) {
  const int number = robot_called(scene, robot);
  const Model& model = *scene.robots[number].model;
  const int f = model.find_frame(frame);
  if (f < 0) throw std::invalid_argument(no_frame(robot, model, frame));
  return {number, model.frames[f].joint, model.frames[f].placement * offset, frame};
}

Attachment world_if_immovable(const Scene& scene, Attachment at) {
  if (at.robot < 0 || at.joint >= 0) return at;
  const Robot& robot = scene.robots[at.robot];
  return {-1, -1, robot.base * at.placement, at.frame.empty() ? "" : robot.name + "/" + at.frame};
}

std::string problem(const Scene& scene, const Attachment& at) {
  const auto of = [](int number, int count) {
    return std::to_string(number) + ", expected a number from -1 to " + std::to_string(count - 1);
  };
  if (at.robot < -1 || at.robot >= scene.nrobots()) return "names robot " + of(at.robot, scene.nrobots());
  const int njoints = at.robot < 0 ? 0 : scene.robots[at.robot].model->njoints();
  if (at.joint < -1 || at.joint >= njoints) return "names joint " + of(at.joint, njoints);
  if (at.robot >= 0 && at.joint < 0 && scene.robots[at.robot].model->floating_base)
    return "names the fixed base of robot " + quote(scene.robots[at.robot].name) + ", which has a floating base";
  return is_finite(at.placement) ? "" : "has a placement that is not finite, expected finite numbers";
}

std::string describe(const Scene& scene, const Attachment& at) {
  const Robot& robot = scene.robots[at.robot];
  const std::string of_robot = " of robot " + quote(robot.name);
  if (!at.frame.empty()) return "frame " + quote(at.frame) + of_robot;
  return at.joint < 0 ? "the base" + of_robot : "joint " + quote(robot.model->joints[at.joint].name) + of_robot;
}

namespace {

// Returns why a contact cannot connect frames A and B, or "" if it can.
std::string problem(const Scene& scene, const Attachment& A, const Attachment& B) {
  if (A.robot < 0) return "has frame A in the world, expected frame A on a robot";
  if (A.robot == B.robot && A.joint == B.joint) {
    const std::string a = describe(scene, A), b = describe(scene, B);
    if (a == b) return "ties " + a + " to itself, expected two bodies";
    return "ties " + a + " to " + b + ", which are on one body, expected two bodies";
  }
  if (A.joint < 0 && B.joint < 0)
    return "fixes " + describe(scene, A) + ", which cannot move, to the world, expected a frame that moves";
  return "";
}

std::string problem_of_support(const Contact& contact) {
  if (contact.mu && !(*contact.mu >= 0 && std::isfinite(*contact.mu)))
    return "has a mu that is not 0 or more, expected a finite number of 0 or more";
  if (contact.mu && contact.type == ContactType::k5D) return "is 5d and has a mu, expected a mu on other types only";
  if (contact.normal && contact.type == ContactType::k5D)
    return "is 5d and has a normal, expected a normal on other types only";
  if (!contact.box.allFinite() || (contact.box.array() < 0).any())
    return "has a box that is not 0 or more, expected finite numbers of 0 or more";
  if (contact.box.isZero(0)) return "";
  if (contact.type != ContactType::k6D)
    return "is " + to_string(contact.type) + " and has a box, expected a box on type 6d only";
  return contact.mu ? "" : "has a box and no mu, expected both box and mu";
}

}  // namespace

int add_contact(Scene& scene, Contact contact) {
  const auto refuse_if = [&](const std::string& what) {
    if (!what.empty()) throw std::invalid_argument("contact " + quote(contact.name) + " " + what);
  };
  refuse_if(problem(scene, contact.A));
  refuse_if(problem(scene, contact.B));
  refuse_if(problem(scene, contact.A, contact.B));
  const bool on_body = contact.B.robot >= 0;
  contact.B = world_if_immovable(scene, std::move(contact.B));
  if (!std::isfinite(contact.alpha) || !std::isfinite(contact.beta))
    refuse_if("has gains that are not finite, expected finite gains");
  if (contact.type == ContactType::k5D && contact.reference_frame != ReferenceFrame::kLocal)
    refuse_if("is 5d in the world's axes, expected reference_frame local, since the axis is fixed in both bodies");
  refuse_if(problem_of_support(contact));
  const auto make_unit = [&](const std::string& name, Vec3<double>& direction) {
    const double norm = direction.stableNorm();
    if (!std::isfinite(norm)) refuse_if("has " + name + " that is not finite, expected a direction");
    if (norm < kZeroDirection) refuse_if("has a zero " + name.substr(name.find(' ') + 1) + ", expected a direction");
    if (std::abs(norm - 1) > 4 * std::numeric_limits<double>::epsilon()) direction /= norm;  // otherwise unchanged
  };
  make_unit("an axis", contact.axis);
  if (contact.normal) {
    make_unit("a normal", *contact.normal);
    if (on_body && contact.B.robot < 0) contact.normal = contact.B.placement.R * *contact.normal;
  }
  if (!scene.contact_index.emplace(contact.name, static_cast<int>(scene.contacts.size())).second)
    refuse_if("exists already, expected names used once");
  scene.contacts.push_back(std::move(contact));
  return static_cast<int>(scene.contacts.size()) - 1;
}

}  // namespace manycontact
