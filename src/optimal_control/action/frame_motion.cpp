#include "manycontact/detail/action/frame_motion.hpp"

#include <stdexcept>

#include "manycontact/detail/algorithm/frames.hpp"

namespace manycontact {

namespace {

const Multibody::BodyFrame& frame_of(const StateAbstract& state, FrameIndex frame) {
  const auto* multibody = dynamic_cast<const StateMultibody*>(&state);
  if (!multibody) throw std::invalid_argument("frame: the state has no robots, a StateMultibody is expected");
  const auto& frames = multibody->get_model()->frames;
  if (static_cast<std::size_t>(frame) >= frames.size())
    throw std::invalid_argument("frame: the state has no frame " + std::to_string(frame));
  return frames[frame];
}

}  // namespace

SE3<double> frame_placement(const StateAbstract& state, const DataCollector& shared, FrameIndex frame) {
  const Multibody::BodyFrame& f = frame_of(state, frame);
  return frame_placement<double>(shared.kinematics(f.robot), shared.scene.robots[f.robot].base, f.joint, f.placement);
}

Vec6<double> frame_velocity(const StateAbstract& state, const DataCollector& shared, FrameIndex frame,
                            ReferenceFrame axes) {
  const Multibody::BodyFrame& f = frame_of(state, frame);
  return frame_velocity<double>(shared.kinematics(f.robot), shared.scene.robots[f.robot].base, f.joint, f.placement,
                                axes);
}

Mat6X<double> frame_jacobian(const StateAbstract& state, const DataCollector& shared, FrameIndex frame,
                             ReferenceFrame axes) {
  const Multibody::BodyFrame& f = frame_of(state, frame);
  const Robot& robot = shared.scene.robots[f.robot];
  Mat6X<double> out = Mat6X<double>::Zero(6, shared.scene.nv);
  frame_jacobian<double>(*robot.model, shared.kinematics(f.robot), robot.base, f.joint, f.placement, axes,
                         out.middleCols(robot.idx_v, robot.model->nv));
  return out;
}

}  // namespace manycontact
