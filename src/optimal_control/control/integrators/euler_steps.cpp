#include "euler_steps.hpp"

#include <typeinfo>

namespace manycontact::internal {

const IntegratedActionDataEuler* find_euler(const ActionDataAbstract& node) {
  const auto* augmented = dynamic_cast<const ActionDataAugmentedLagrangian*>(&node);
  return dynamic_cast<const IntegratedActionDataEuler*>(augmented ? augmented->inner.get() : &node);
}

const IntegratedActionDataEuler* known_steps(const ActionModelAbstract& model, const ActionDataAbstract& node) {
  const IntegratedActionDataEuler* euler = find_euler(node);
  if (!euler || !euler->joints_are_known) return nullptr;
  const auto* augmented = dynamic_cast<const ActionModelAugmentedLagrangian*>(&model);
  const ActionModelAbstract& own = augmented ? *augmented->get_model() : model;
  return !node.has_matrices() || typeid(own) == typeid(IntegratedActionModelEuler) ? euler : nullptr;
}

void fill_steps(const IntegratedActionDataEuler& euler, lq::SymplecticStructure& out) {
  const auto fill = [&](lq::BlockDiagonal& D, double scale, Mat6<double> IntegratedActionDataEuler::WideJoint::*which) {
    D.scale = scale;
    D.parts.resize(euler.wide_joints.size());
    for (std::size_t k = 0; k < D.parts.size(); ++k) {
      const IntegratedActionDataEuler::WideJoint& joint = euler.wide_joints[k];
      D.parts[k].first = joint.first;
      D.parts[k].block = scale * (joint.*which).topLeftCorner(joint.size, joint.size);
    }
  };
  fill(out.J, 1, &IntegratedActionDataEuler::WideJoint::of_x);
  fill(out.G, euler.step, &IntegratedActionDataEuler::WideJoint::of_dx);
}

}  // namespace manycontact::internal
