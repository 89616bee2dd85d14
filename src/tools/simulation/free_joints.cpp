#include "manycontact/simulation/free_joints.hpp"

#include "internal.hpp"
#include "manycontact/spatial/explog.hpp"
#include "momentum_steps.hpp"

namespace manycontact::internal {

namespace {

template <class Use>
void each_free_joint(const Scene& scene, Use&& use) {
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints)
      if (joint.nv() > 1) use(joint, robot.idx_q + joint.idx_q, robot.idx_v + joint.idx_v);
}

// Returns the number of translational coordinates of a free joint, which precede its rotational coordinates.
int displacing(const Joint& joint) { return joint.type == JointType::kPlanar ? 2 : 3; }

Mat3<double> axes_at(const Joint& joint, int at, const Eigen::VectorXd& q) {
  return joint.type == JointType::kPlanar ? exp3<double>(Vec3<double>(0, 0, q[at + 2]))
                                          : placement_of_pose(q.segment<7>(at)).R;
}

}  // namespace

void stop_in_a_step(const Scene& scene, const Eigen::VectorXd& v, double h, Eigen::VectorXd& a) {
  a = v / -h;
  each_free_joint(scene, [&](const Joint& joint, int, int i) {
    const Vec6<double> V = as_floating(joint, v.segment(i, joint.nv()));
    const Vec3<double> turn = V.tail<3>().cross(V.head<3>());
    a.segment(i, displacing(joint)) -= turn.head(displacing(joint));
  });
}

OfFreeJoint derivative_of_turn(const Joint& joint, const ConstVectorRef& v) {
  const Vec6<double> V = as_floating(joint, v);
  const int n = displacing(joint), turning = joint.nv() - n;
  OfFreeJoint out = OfFreeJoint::Zero(joint.nv(), joint.nv());
  out.topLeftCorner(n, n) = skew<double>(V.tail<3>()).topLeftCorner(n, n);
  out.topRightCorner(n, turning) = -skew<double>(V.head<3>()).topRightCorner(n, turning);
  return out;
}

void end_free_joints(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& x, double h,
                     Eigen::VectorXd& scratch, Eigen::VectorXd& q_next, Eigen::VectorXd& v_next) {
  scratch = h * x;
  v_next = x;
  each_free_joint(scene, [&](const Joint& joint, int, int i) { scratch.segment(i, displacing(joint)).setZero(); });
  integrate_scene(scene, q, scratch, q_next);
  each_free_joint(scene, [&](const Joint& joint, int at, int i) {
    const int n = displacing(joint);
    const Vec6<double> X = as_floating(joint, v_next.segment(i, joint.nv()));
    const Vec3<double> linear = X.head<3>(), turned = exp3<double>(-h * X.tail<3>()) * linear;
    q_next.segment(at, n) += (h * (axes_at(joint, at, q) * linear)).head(n);
    v_next.segment(i, n) = turned.head(n);
  });
}

// With E = exp(h x_angular), J its right Jacobian and dt = J h dx_angular, the derivatives of the step's end are
//     dq+ = E^T dq + [h E^T (dx_linear - x_linear x dq_angular); dt]
//     dv+ = [E^T dx_linear + v+_linear x dt; dx_angular]
void differentiate_free_joints(const Scene& scene, const Eigen::VectorXd& x, double h, Eigen::MatrixXd& F) {
  each_free_joint(scene, [&](const Joint& joint, int, int i) {
    const Vec6<double> X = as_floating(joint, x.segment(i, joint.nv()));
    Vec6<double> turn = h * X;
    turn.head<3>().setZero();
    const Vec3<double> linear = X.head<3>();
    const Mat3<double> back = exp3<double>(-turn.tail<3>()), J = Jexp6<double>(turn).bottomRightCorner<3, 3>();
    const Vec3<double> next = back * linear;
    for (Eigen::Index c = 0; c < F.cols(); ++c) {
      auto of_q = F.col(c).segment(i, joint.nv()), of_v = F.col(c).segment(scene.nv + i, joint.nv());
      const Vec6<double> moved = as_floating(joint, of_q), dx = as_floating(joint, of_v);
      const Vec3<double> dq = moved.tail<3>() - h * dx.tail<3>(), dt = h * (J * dx.tail<3>());
      of_q.setZero(), of_v.setZero();
      add_motion(joint, back * (moved.head<3>() - h * linear.cross(dq)), back * dq + dt, of_q);
      add_motion(joint, back * dx.head<3>() + next.cross(dt), dx.tail<3>(), of_v);
    }
  });
}

}  // namespace manycontact::internal
