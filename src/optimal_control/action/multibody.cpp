#include "manycontact/action/multibody.hpp"

#include <limits>

namespace manycontact {

Multibody::Multibody(const Scene& scene) : scene_(scene) {
  scene_.contacts.clear();
  scene_.contact_index.clear();
  scene_.damping = 0;
  index();
}

Multibody::Multibody(std::shared_ptr<const Model> model, const SE3<double>& base) {
  require(model != nullptr, "Multibody", "a model is expected, not a null pointer");
  const std::string name = model->name.empty() ? "robot" : model->name;
  add_robot(scene_, name, std::move(model), base);
  index();
}

void Multibody::index() {
  const bool alone = scene_.nrobots() == 1;
  nq = scene_.nq;
  nv = scene_.nv;
  armature.resize(nv);
  effortLimit.setConstant(nv, std::numeric_limits<double>::infinity());
  for (int r = 0; r < scene_.nrobots(); ++r) {
    const Robot& robot = scene_.robots[r];
    const Model& model = *robot.model;
    armature.segment(robot.idx_v, model.nv) = model.armature;
    for (const Joint& joint : model.joints)
      if (joint.effort_limit.size() == joint.nv())
        effortLimit.segment(robot.idx_v + joint.idx_v, joint.nv()) = joint.effort_limit;
    if (model.floating_base) effortLimit.segment<6>(robot.idx_v).setConstant(std::numeric_limits<double>::infinity());
    for (const Frame& frame : model.frames) {
      const std::string name = robot.name + "/" + frame.name;
      frame_index_[name] = frames.size();
      if (alone) frame_index_.try_emplace(frame.name, frames.size());
      frames.push_back({alone ? frame.name : name, r, frame.joint, frame.placement});
    }
    std::size_t id = frames.size() - model.frames.size();
    for (const Frame& frame : model.frames) {
      if (!frame.parent_joint.empty()) {
        frame_index_.try_emplace(robot.name + "/" + frame.parent_joint, id);
        if (alone) frame_index_.try_emplace(frame.parent_joint, id);
      }
      ++id;
    }
  }
}

const std::size_t* Multibody::find(const std::string& name) const {
  const auto it = frame_index_.find(name);
  return it == frame_index_.end() ? nullptr : &it->second;
}

FrameIndex Multibody::getFrameId(const std::string& name) const {
  const std::size_t* id = find(name);
  require(id, "Multibody::getFrameId",
          "no frame is called \"" + name + "\"; " +
              (scene_.nrobots() == 1 ? "the name of a link is expected"
                                     : "with several robots \"robot/link\" is expected, such as \"" +
                                           (frames.empty() ? std::string("robot/link") : frames[0].name) + "\""));
  return *id;
}

}  // namespace manycontact
