#include "goal_rows.hpp"

#include <algorithm>
#include <cmath>

#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/detail/contact/rows.hpp"
#include "manycontact/spatial/explog.hpp"
#include "manycontact/spatial/rpy.hpp"

namespace manycontact::internal {

namespace {

using Vec3d = Vec3<double>;
using Mat3d = Mat3<double>;

bool all(const Partial& x) { return x[0] && x[1] && x[2]; }

// Returns the derivative of log3: log3(R exp3(d)) = w + log3_derivative(w) d to first order, with w = log3(R).
Mat3d log3_derivative(const Vec3d& w) {
  Vec6<double> xi = Vec6<double>::Zero();
  xi.tail<3>() = w;
  return Jlog6<double>(xi).bottomRightCorner<3, 3>();
}

// Returns the rotation vector (axis times angle) that rotates the unit vector `from` to `to`.
Vec3d turning(const Vec3d& from, const Vec3d& to) {
  const Vec3d c = from.cross(to);
  const double sine = c.norm(), angle = std::atan2(sine, from.dot(to));
  if (sine > 0) return c * (angle / sine);
  return angle > 1 ? Vec3d(angle * across(from).row(0).transpose()) : Vec3d(Vec3d::Zero());
}

// A rotation error e of a frame, and its Jacobian with respect to the frame's angular velocity in the frame's axes.
struct Turned {
  Eigen::VectorXd e;
  Eigen::Matrix<double, Eigen::Dynamic, 3> of_spin;
  double angle = 0;  // angle of the rotation that remains to the goal [rad]
};

// Returns the errors of those angles among roll, pitch and yaw that `rpy` prescribes, with their Jacobian.
Turned by_angles(const Mat3d& R, const Partial& rpy) {
  constexpr double kLeastCosine = 1e-3;  // cosine of pitch below which roll and yaw are not defined
  const double pitch = std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
  const double roll = std::atan2(R(2, 1), R(2, 2)), yaw = std::atan2(R(1, 0), R(0, 0));
  const double s = std::sin(roll), c = std::cos(roll);
  const double cp = std::max(std::cos(pitch), kLeastCosine), tp = std::sin(pitch) / cp;
  const double now[3] = {roll, pitch, yaw};
  Mat3d rates;
  rates << 1, s * tp, c * tp, 0, c, -s, 0, s / cp, c / cp;
  Turned out;
  for (int k = 0; k < 3; ++k) {
    if (!rpy[k]) continue;
    const Eigen::Index n = out.e.size();
    out.e.conservativeResize(n + 1);
    out.of_spin.conservativeResize(n + 1, 3);
    out.e[n] = std::remainder(now[k] - *rpy[k], 2 * M_PI);
    out.of_spin.row(n) = rates.row(k);
  }
  out.angle = out.e.norm();
  return out;
}

Turned turned_from(const Mat3d& R, const Goal& goal) {
  const Partial& rpy = goal.rpy;
  Turned out;
  if (goal.axes || all(rpy)) {
    const Mat3d wanted = goal.axes ? *goal.axes : rotation_of_rpy(*rpy[0], *rpy[1], *rpy[2]);
    const Vec3d w = log3<double>(wanted.transpose() * R);
    out.e = w;
    out.of_spin = log3_derivative(w);
    out.angle = w.norm();
  } else if (rpy[0] && rpy[1]) {  // rotation error of the world's z axis, in the frame's axes
    const Vec3d wanted = rotation_of_rpy(*rpy[0], *rpy[1], 0).transpose().col(2);
    const Vec3d w = turning(R.transpose().col(2), wanted);
    const Eigen::Matrix<double, 2, 3> T = across(wanted);
    out.e = T * w;
    out.of_spin = T;
    out.angle = w.norm();
  } else {
    out = by_angles(R, rpy);
  }
  return out;
}

RigidBodies bodies_of(const Scene& scene, int robot) {
  return robot < 0 ? RigidBodies(scene) : RigidBodies(scene, scene.robots[robot].name);
}

}  // namespace

struct GoalRows::Rows {  // appends the rows of one goal to the errors e_ and the Jacobian J_
  GoalRows& to;
  bool with_jacobian;
  double root;  // square root of the goal's weight
  GoalLeft left = {};

  int add(double e) {  // appends a row with the error e; returns the row's number
    to.e_.push_back(root * e);
    return static_cast<int>(to.e_.size()) - 1;
  }
  void add(int row, int column, double x) { to.J_.emplace_back(row, column, root * x); }
};

GoalRows::GoalRows(const Scene& scene, const std::vector<Goal>& goals) : scene_(scene), goals_(goals) {
  kin_.resize(scene.robots.size());
  const auto need = [&](int robot) {
    if (robot >= 0 && !kin_[robot]) kin_[robot] = std::make_unique<Kinematics<double>>(*scene.robots[robot].model);
  };
  for (const Goal& goal : goals) {
    if (goal.target == Goal::Target::kFrame) need(goal.frame.robot);
    if (goal.target == Goal::Target::kCenterOfMass) of_bodies_.try_emplace(goal.robot, bodies_of(scene, goal.robot));
    for (const Attachment& frame : goal.from) need(frame.robot);
    if (goal.target != Goal::Target::kContact) continue;
    need(scene.contacts[goal.contact].A.robot);
    need(scene.contacts[goal.contact].B.robot);
  }
}

Eigen::VectorXd GoalRows::errors(const Eigen::VectorXd& q) {
  q_ = q;
  for (std::size_t r = 0; r < kin_.size(); ++r) {
    const Robot& robot = scene_.robots[r];
    if (kin_[r])
      forward_kinematics<double>(*robot.model, robot.base, q.segment(robot.idx_q, robot.model->nq), *kin_[r]);
  }
  for (auto& [robot, data] : of_bodies_) {
    const RigidBodies bodies = bodies_of(scene_, robot);
    forward_kinematics(bodies, q.segment(robot < 0 ? 0 : scene_.robots[robot].idx_q, bodies.nq()), data);
  }
  evaluate(false);
  return Eigen::Map<const Eigen::VectorXd>(e_.data(), static_cast<Eigen::Index>(e_.size()));
}

Eigen::SparseMatrix<double> GoalRows::jacobian() {
  evaluate(true);
  Eigen::SparseMatrix<double> J(static_cast<Eigen::Index>(e_.size()), scene_.nv);
  J.setFromTriplets(J_.begin(), J_.end());
  return J;
}

void GoalRows::evaluate(bool with_jacobian) {
  e_.clear();
  J_.clear();
  left_.clear();
  for (const Goal& goal : goals_) {
    Rows rows{*this, with_jacobian, std::sqrt(goal.weight)};
    switch (goal.target) {
      case Goal::Target::kFrame:
        frame_rows(goal, rows);
        break;
      case Goal::Target::kCenterOfMass:
        center_rows(goal, rows);
        break;
      case Goal::Target::kJoint:
        joint_rows(goal, rows);
        break;
      case Goal::Target::kContact:
        contact_rows_of(goal, rows);
        break;
    }
    left_.push_back(rows.left);
  }
}

void GoalRows::frame_rows(const Goal& goal, Rows& rows) {
  const Robot& robot = scene_.robots[goal.frame.robot];
  const Model& model = *robot.model;
  const Kinematics<double>& k = kin(goal.frame.robot);
  const SE3<double> M = placed(goal.frame);
  const Turned turned = turned_from(M.R, goal);
  std::vector<int> chain;
  Mat6X<double> J;  // frame Jacobian in the frame's axes
  if (rows.with_jacobian) {
    chain = dof_chain(model, goal.frame.joint);
    J.resize(6, model.nv);
    frame_jacobian<double>(model, k, robot.base, goal.frame.joint, goal.frame.placement, ReferenceFrame::kLocal, J);
  }
  const Vec3d from = middle(goal.from);
  Vec3d off = Vec3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    if (!goal.position[axis]) continue;
    off[axis] = M.p[axis] - from[axis] - *goal.position[axis];
    const int row = rows.add(off[axis]);
    for (const int i : chain) rows.add(row, robot.idx_v + i, M.R.row(axis).dot(J.col(i).head<3>()));
    take_middle(goal.from, axis, row, rows);
  }
  for (Eigen::Index n = 0; n < turned.e.size(); ++n) {
    const int row = rows.add(turned.e[n]);
    for (const int i : chain) rows.add(row, robot.idx_v + i, turned.of_spin.row(n).dot(J.col(i).tail<3>()));
  }
  rows.left = {off.norm(), turned.angle};
}

void GoalRows::center_rows(const Goal& goal, Rows& rows) {
  const RigidBodies bodies = bodies_of(scene_, goal.robot);
  RigidBodyData& data = of_bodies_.at(goal.robot);
  Vec3d c = center_of_mass(bodies, data);
  c -= middle(goal.from);
  const int first = goal.robot < 0 ? 0 : scene_.robots[goal.robot].idx_v;
  Eigen::Matrix3Xd J;
  if (rows.with_jacobian) J = center_of_mass_jacobian(bodies, data);
  Vec3d off = Vec3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    if (!goal.position[axis]) continue;
    off[axis] = c[axis] - *goal.position[axis];
    const int row = rows.add(off[axis]);
    for (Eigen::Index i = 0; i < J.cols(); ++i) rows.add(row, first + static_cast<int>(i), J(axis, i));
    take_middle(goal.from, axis, row, rows);
  }
  rows.left.position = off.norm();
}

SE3<double> GoalRows::placed(const Attachment& frame) const {
  return frame_placement<double>(kin(frame.robot), scene_.robots[frame.robot].base, frame.joint, frame.placement);
}

Vec3d GoalRows::middle(const std::vector<Attachment>& frames) const {
  Vec3d sum = Vec3d::Zero();
  for (const Attachment& frame : frames) sum += placed(frame).p;
  return frames.empty() ? sum : Vec3d(sum / static_cast<double>(frames.size()));
}

// Subtracts from a row of J the motion of the mean of the origins of `frames` along a world axis.
void GoalRows::take_middle(const std::vector<Attachment>& frames, int axis, int row, Rows& rows) {
  if (!rows.with_jacobian) return;
  for (const Attachment& frame : frames) {
    const Robot& robot = scene_.robots[frame.robot];
    Mat6X<double> J(6, robot.model->nv);
    frame_jacobian<double>(*robot.model, kin(frame.robot), robot.base, frame.joint, frame.placement,
                           ReferenceFrame::kLocalWorldAligned, J);
    for (const int i : dof_chain(*robot.model, frame.joint))
      rows.add(row, robot.idx_v + i, -J(axis, i) / static_cast<double>(frames.size()));
  }
}

void GoalRows::joint_rows(const Goal& goal, Rows& rows) {
  const Robot& robot = scene_.robots[goal.robot];
  const Joint& joint = robot.model->joints[goal.joint];
  const double off = q_[robot.idx_q + joint.idx_q] - goal.value;
  const int row = rows.add(off);
  if (rows.with_jacobian) rows.add(row, robot.idx_v + joint.idx_v, 1);
  (joint.type == JointType::kPrismatic ? rows.left.position : rows.left.angle) = std::abs(off);
}

// Adds the rows of a contact goal, in the contact's axes. A 6D contact uses p and log3(R) instead of log6 of its
// placement error (R, p); both vanish together.
void GoalRows::contact_rows_of(const Goal& goal, Rows& rows) {
  const Contact& contact = scene_.contacts[goal.contact];
  const ContactSupport support = rows.with_jacobian ? contact_support(scene_, contact) : ContactSupport();
  ContactData<double> d(contact, support);
  contact_rows<double>(scene_, contact, support, kin(contact.A.robot),
                       contact.B.robot < 0 ? nullptr : &kin(contact.B.robot), d);
  Vec6<double> x = Vec6<double>::Zero();
  x.head<3>() = d.G.R.transpose() * d.G.p;
  Mat3d of_spin = Mat3d::Identity();
  if (contact.type == ContactType::k6D) {
    const Vec3d w = log3<double>(d.G.R);
    x.tail<3>() = w;
    of_spin = log3_derivative(w);
  } else if (contact.type == ContactType::k5D) {
    x.tail<3>() = turning(d.G.R.transpose() * contact.axis, contact.axis);
  }
  if (rows.with_jacobian) d.Jl.bottomRows<3>() = (of_spin * d.Jl.bottomRows<3>()).eval();
  const Eigen::VectorXd e = d.W * x;
  const Eigen::MatrixXd J = d.W * d.Jl;
  for (Eigen::Index n = 0; n < e.size(); ++n) {
    const int row = rows.add(e[n]);
    Eigen::Index column = 0;
    for (const int i : support.a) rows.add(row, scene_.robots[contact.A.robot].idx_v + i, J(n, column++));
    for (const int i : support.b) rows.add(row, scene_.robots[contact.B.robot].idx_v + i, J(n, column++));
  }
  const Eigen::Index held = std::min<Eigen::Index>(3, e.size());
  rows.left = {e.head(held).norm(), e.tail(e.size() - held).norm()};
}

}  // namespace manycontact::internal
