// Functions of algorithm/rigid_body.hpp for frames, for sums over all bodies, and for joint wrenches.

#include "manycontact/detail/algorithm/energy.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "rigid_body_memory.hpp"

namespace manycontact {

using internal::each_robot;
using internal::memory_of;
using internal::RigidBodyMemory;
using internal::RobotMemory;

namespace {

using Vec6d = Vec6<double>;
using Vec3d = Vec3<double>;

// The robot on which a frame is, and the robot's memory; both are nullptr for a frame of the world.
struct Owner {
  const Robot* robot = nullptr;
  RobotMemory* memory = nullptr;
};
Owner owner_of(const char* function, const RigidBodies& bodies, RigidBodyMemory& m, int robot, int joint) {
  if (robot < 0) return {};
  const int number = robot - bodies.first();
  const std::span<const Robot> robots = bodies.robots();
  if (number < 0 || number >= static_cast<int>(robots.size()))
    throw std::invalid_argument(std::string(function) + ": robot " + std::to_string(robot) +
                                " is not one of these robots");
  const Robot* out = &robots[static_cast<std::size_t>(number)];
  if (joint < -1 || joint >= out->model->njoints())
    throw std::invalid_argument(std::string(function) + ": robot '" + out->name + "' has no joint " +
                                std::to_string(joint));
  return {out, &m.robots[static_cast<std::size_t>(number)]};
}

// Returns read(robot, kin) for a frame's robot, after computing velocities; zero for a frame of the world.
template <class Read>
Vec6d motion(const char* function, const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
             Read&& read) {
  RigidBodyMemory& m = memory_of(function, bodies, data);
  const Owner of = owner_of(function, bodies, m, frame.robot, frame.joint);
  if (!of.robot) return Vec6d::Zero();
  internal::move(bodies, m);
  return read(*of.robot, of.memory->kin);
}

}  // namespace

SE3<double> frame_placement(const RigidBodies& bodies, const RigidBodyData& data, const Attachment& frame) {
  RigidBodyMemory& m = memory_of("frame_placement", bodies, data);
  const Owner of = owner_of("frame_placement", bodies, m, frame.robot, frame.joint);
  if (!of.robot) return frame.placement;
  return frame_placement<double>(of.memory->kin, of.robot->base, frame.joint, frame.placement);
}

Vec6d frame_velocity(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame, ReferenceFrame axes) {
  return motion("frame_velocity", bodies, data, frame, [&](const Robot& robot, const Kinematics<double>& kin) {
    return frame_velocity<double>(kin, robot.base, frame.joint, frame.placement, axes);
  });
}

Vec6d frame_acceleration(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame, ReferenceFrame axes) {
  return motion("frame_acceleration", bodies, data, frame, [&](const Robot& robot, const Kinematics<double>& kin) {
    return frame_acceleration<double>(kin, robot.base, frame.joint, frame.placement, axes);
  });
}

Vec6d frame_classical_acceleration(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
                                   ReferenceFrame axes) {
  return motion("frame_classical_acceleration", bodies, data, frame,
                [&](const Robot& robot, const Kinematics<double>& kin) {
                  return frame_classical_acceleration<double>(kin, robot.base, frame.joint, frame.placement, axes);
                });
}

Mat6X<double> frame_jacobian(const RigidBodies& bodies, const RigidBodyData& data, const Attachment& frame,
                             ReferenceFrame axes) {
  RigidBodyMemory& m = memory_of("frame_jacobian", bodies, data);
  const auto [robot, of] = owner_of("frame_jacobian", bodies, m, frame.robot, frame.joint);
  Mat6X<double> J = Mat6X<double>::Zero(6, bodies.nv());
  if (robot)
    frame_jacobian<double>(*robot->model, of->kin, robot->base, frame.joint, frame.placement, axes,
                           J.middleCols(bodies.idx_v(*robot), robot->model->nv));
  return J;
}

Vec6d frame_bias_acceleration(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
                              ReferenceFrame axes) {
  const Vec6d rate = axes == ReferenceFrame::kLocalWorldAligned
                         ? frame_classical_acceleration(bodies, data, frame, axes)
                         : frame_acceleration(bodies, data, frame, axes);
  const Eigen::VectorXd& a = data.memory->a;
  return a.isZero(0) ? rate : Vec6d(rate - frame_jacobian(bodies, data, frame, axes) * a);
}

// ---- sums over all bodies ------------------------------------------------------------------------------------------

namespace {

// Sums the forces or momenta of(kinematics, body), in the tree frame, over all bodies, about the centre of mass.
template <class Of>
Vec6d about_center(const RigidBodies& bodies, RigidBodyData& data, Of&& of) {
  internal::move(bodies, *data.memory);
  const Vec3d c = center_of_mass(bodies, data);
  Vec6d sum = Vec6d::Zero();
  for (const RobotMemory& r : data.memory->robots)
    for (std::size_t i = 0; i < r.kin.Y.size(); ++i) {
      const Vec6d f = of(r.kin, i);
      sum += f;
      sum.tail<3>() -= (c - r.kin.origin(static_cast<int>(i))).cross(Vec3d(f.head<3>()));  // n - c x f
    }
  return sum;
}

}  // namespace

double total_mass(const RigidBodies& bodies) {
  double mass = 0;
  for (const Robot& robot : bodies.robots())
    for (const Joint& joint : robot.model->joints) mass += joint.inertia.m;
  return mass;
}

Vec3d center_of_mass(const RigidBodies& bodies, const RigidBodyData& data) {
  const RigidBodyMemory& m = memory_of("center_of_mass", bodies, data);
  Vec3d sum = Vec3d::Zero();
  for (const RobotMemory& of : m.robots)
    for (std::size_t i = 0; i < of.kin.Y.size(); ++i)
      sum += of.kin.Y[i].m * of.kin.origin(static_cast<int>(i)) + of.kin.Y[i].h;
  return sum / total_mass(bodies);
}

Vec3d center_of_mass_velocity(const RigidBodies& bodies, RigidBodyData& data) {
  return centroidal_momentum(bodies, data).head<3>() / total_mass(bodies);
}

Vec3d center_of_mass_acceleration(const RigidBodies& bodies, RigidBodyData& data) {
  return centroidal_momentum_rate(bodies, data).head<3>() / total_mass(bodies);
}

Eigen::Matrix3Xd center_of_mass_jacobian(const RigidBodies& bodies, RigidBodyData& data) {
  return centroidal_momentum_matrix(bodies, data).topRows<3>() / total_mass(bodies);
}

Vec6d centroidal_momentum(const RigidBodies& bodies, RigidBodyData& data) {
  (void)memory_of("centroidal_momentum", bodies, data);
  return about_center(bodies, data, [](const Kinematics<double>& kin, std::size_t i) { return kin.Y[i] * kin.v[i]; });
}

Mat6X<double> centroidal_momentum_matrix(const RigidBodies& bodies, RigidBodyData& data) {
  RigidBodyMemory& m = memory_of("centroidal_momentum_matrix", bodies, data);
  internal::compose(bodies, m);
  const Vec3d c = center_of_mass(bodies, data);
  Mat6X<double> A(6, bodies.nv());
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int iv) {
    for (int k = 0; k < robot.model->nv; ++k) {
      const int joint = robot.model->dof_joint[k];
      Vec6d h = of.Yc[joint] * of.kin.J.col(k);
      h.tail<3>() -= (c - of.kin.origin(joint)).cross(Vec3d(h.head<3>()));
      A.col(iv + k) = h;
    }
  });
  return A;
}

Vec6d centroidal_momentum_rate(const RigidBodies& bodies, RigidBodyData& data) {
  (void)memory_of("centroidal_momentum_rate", bodies, data);
  return about_center(bodies, data, [](const Kinematics<double>& kin, std::size_t i) -> Vec6d {
    return add_cross_force(kin.Y[i] * Vec6d(kin.a[i] - kin.a_base), kin.v[i], kin.Y[i] * kin.v[i]);  // Y a + v x* Y v
  });
}

double kinetic_energy(const RigidBodies& bodies, RigidBodyData& data) {
  RigidBodyMemory& m = memory_of("kinetic_energy", bodies, data);
  internal::move(bodies, m);
  double energy = 0;
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int iv) {
    energy += kinetic_energy<double>(*robot.model, of.kin, m.v.segment(iv, robot.model->nv));
  });
  return energy;
}

double potential_energy(const RigidBodies& bodies, const RigidBodyData& data) {
  double energy = 0;
  const RigidBodyMemory& m = memory_of("potential_energy", bodies, data);
  for (const RobotMemory& of : m.robots) energy += potential_energy<double>(of.kin, bodies.gravity());
  internal::each_joint_spring(bodies, [&](const JointSpring& s, int iq, int) {
    energy += 0.5 * s.stiffness * (m.q[iq] - s.rest) * (m.q[iq] - s.rest);
  });
  return energy;
}

// ---- wrenches that joints transmit ---------------------------------------------------------------------------------

namespace {

// Returns the frame of a file joint's child link if that link is the joint's parent in the tree, or nullptr.
const Frame* child_behind(const Model& model, int joint) {
  const std::string& name = model.joints[joint].name;
  for (const Frame& frame : model.frames)
    if (frame.parent_joint == name) return frame.joint == model.joints[joint].parent ? &frame : nullptr;
  return nullptr;
}

}  // namespace

Vec6d joint_wrench(const RigidBodies& bodies, const RigidBodyData& data, const BodyJoint& joint) {
  RigidBodyMemory& m = memory_of("joint_wrench", bodies, data);
  const auto [robot, of] = owner_of("joint_wrench", bodies, m, joint.robot, joint.joint);
  if (!robot || joint.joint < 0)
    throw std::invalid_argument("joint_wrench: the world has no joint, a joint of a robot is expected");
  if (!m.carries)
    throw std::logic_error(
        "joint_wrench: the data have no forces, call rnea, nonlinear_effects or gravity_torques first");
  const Vec6d& on_subtree = of->f[joint.joint];
  const Frame* child = child_behind(*robot->model, joint.joint);
  if (!child) return of->kin.oMi[joint.joint].inverse().act_force(on_subtree);
  const SE3<double> base{robot->base.R, robot->base.p - of->kin.origin(joint.joint)};
  const SE3<double>& body = child->joint < 0 ? base : of->kin.oMi[child->joint];
  return (body * child->placement).inverse().act_force(-on_subtree);
}

}  // namespace manycontact
