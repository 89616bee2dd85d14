#include "manycontact/model/rigid_bodies.hpp"

#include <functional>
#include <stdexcept>

#include "manycontact/model/suggestion.hpp"

namespace manycontact {

RigidBodies::RigidBodies(const Scene& scene, const std::string& robot)
    : scene_(&scene), first_(robot_called(scene, robot)), count_(1) {}

RigidBodies::RigidBodies(const Model& model, const SE3<double>& base, const Vec3<double>& gravity) : gravity_(gravity) {
  if (!is_finalized(model))
    throw std::invalid_argument("RigidBodies: the model is not finalized, call finalize(model) first");
  alone_.emplace();
  alone_->name = model.name;
  alone_->model = std::shared_ptr<const Model>(std::shared_ptr<void>(), &model);  // the caller owns the model
  alone_->base = base;
}

std::span<const Robot> RigidBodies::robots() const {
  if (alone_) return {&*alone_, 1};
  const std::span<const Robot> all = scene_->robots;
  return count_ < 0 ? all : all.subspan(static_cast<std::size_t>(first_), static_cast<std::size_t>(count_));
}

namespace {

int sum(const RigidBodies& bodies, int (*of)(const Model&)) {
  int total = 0;
  for (const Robot& robot : bodies.robots()) total += of(*robot.model);
  return total;
}

}  // namespace

int RigidBodies::nq() const {
  return sum(*this, [](const Model& m) { return m.nq; });
}
int RigidBodies::nv() const {
  return sum(*this, [](const Model& m) { return m.nv; });
}
int RigidBodies::njoints() const {
  return sum(*this, [](const Model& m) { return m.njoints(); });
}

namespace {

// Returns the number of the frame of a link, or of a (possibly fixed) joint's child link, or -1.
int frame_number(const Model& model, const std::string& name) {
  const int frame = model.find_frame(name);
  if (frame >= 0 || name.empty()) return frame;
  for (std::size_t i = 0; i < model.frames.size(); ++i)
    if (model.frames[i].parent_joint == name) return static_cast<int>(i);
  return -1;
}

struct Found {
  int robot = 0, number = 0;
};

// Returns the robot, and the item's number(model, name) in it, of a joint or frame called "robot/name", or just "name"
// if there is only one robot. Throws std::invalid_argument with the text none(robot, name) if the robot has none.
template <class Number, class None>
Found find(const RigidBodies& bodies, const std::string& name, Number&& number, None&& none) {
  const std::span<const Robot> robots = bodies.robots();
  if (robots.size() == 1)
    if (const int k = number(*robots[0].model, name); k >= 0) return {0, k};
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const std::string& own = robots[r].name;
    if (name.size() <= own.size() || name[own.size()] != '/' || !name.starts_with(own)) continue;
    const std::string inside = name.substr(own.size() + 1);
    if (const int k = number(*robots[r].model, inside); k >= 0) return {static_cast<int>(r), k};
    throw std::invalid_argument(none(robots[r], inside));
  }
  if (robots.size() == 1) throw std::invalid_argument(none(robots[0], name));
  std::vector<std::string> known;
  for (const Robot& robot : robots) known.push_back(robot.name);
  const std::string robot = name.substr(0, name.find('/'));
  throw std::invalid_argument(name == robot ? quote(name) + " names no robot, expected robot/name"
                                            : "there is no robot " + quote(robot) + ", " + suggestion(robot, known));
}

template <class Named>
std::vector<std::string> names(const RigidBodies& bodies, std::vector<Named> Model::*list) {
  const bool alone = bodies.robots().size() == 1;
  std::vector<std::string> out;
  for (const Robot& robot : bodies.robots())
    for (const Named& item : (*robot.model).*list) out.push_back(alone ? item.name : robot.name + "/" + item.name);
  return out;
}

}  // namespace

Attachment find_frame(const RigidBodies& bodies, const std::string& name) {
  const Found found = find(bodies, name, frame_number, [](const Robot& robot, const std::string& frame) {
    return no_frame(robot.name, *robot.model, frame);
  });
  const Frame& frame = bodies.robots()[static_cast<std::size_t>(found.robot)].model->frames[found.number];
  return {bodies.first() + found.robot, frame.joint, frame.placement, frame.name};
}

BodyJoint find_joint(const RigidBodies& bodies, const std::string& name) {
  const auto none = [](const Robot& robot, const std::string& joint) {
    return "robot " + quote(robot.name) + ": " + no_joint(*robot.model, joint);
  };
  const Found found = find(bodies, name, std::mem_fn(&Model::find_joint), none);
  return {bodies.first() + found.robot, found.number};
}

std::vector<std::string> frame_names(const RigidBodies& bodies) { return names(bodies, &Model::frames); }
std::vector<std::string> joint_names(const RigidBodies& bodies) { return names(bodies, &Model::joints); }

}  // namespace manycontact
