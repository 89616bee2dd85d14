#include "pinocchio_model.hpp"

namespace manycontact::bench {

namespace {

pin::JointModel joint(const Joint& j) {
  if (j.type == JointType::kFloating) return pin::JointModelFreeFlyer();
  if (j.axis_kind == 0) return pin::JointModelRX();
  if (j.axis_kind == 1) return pin::JointModelRY();
  if (j.axis_kind == 2) return pin::JointModelRZ();
  return pin::JointModelRevoluteUnaligned(j.axis);
}

}  // namespace

pin::Model model_of(const Posed& s) {
  pin::Model model;
  model.gravity.linear() = s.scene.gravity;
  const std::vector<Body> bodies = bodies_of(s);
  std::size_t k = 0;
  for (const Robot& r : s.scene.robots)
    for (const Joint& j : r.model->joints) {
      const Body& b = bodies[k++];
      const SE3<double> on_parent = j.parent < 0 && j.type != JointType::kFloating ? r.base * j.placement : j.placement;
      const auto id = model.addJoint(b.parent + 1, joint(j), place(on_parent), r.name + "/" + j.name);
      model.appendBodyToJoint(id, pin::Inertia(b.mass, b.com, b.inertia));
    }
  if (s.scene.nrobots() == 1 && !s.scene.contacts.empty()) {
    const Attachment& held = s.scene.contacts.front().A;
    model.addFrame(pin::Frame("held", held.joint + 1, 0, place(held.placement), pin::OP_FRAME));
  }
  return model;
}

}  // namespace manycontact::bench
