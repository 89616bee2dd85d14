// Joint types are tested one by one against equations known in closed form.

#include "algorithm/shapes.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// There is one joint at the base, whose body's numbers are known.
struct OneJoint {
  double m = 1.7;
  Vec3<double> c;   // centre of mass
  Mat3<double> Ic;  // about it
  Specimen s;

  explicit OneJoint(JointType type, bool centred = false)
      : s({.njoints = 1, .floating_base = type == JointType::kFloating, .types = {type}}) {
    c = centred ? Vec3<double>(Vec3<double>::Zero()) : Vec3<double>(0.2, -0.1, 0.3);
    const Mat3<double> R = random_rotation(s.rng);
    Ic = R * Vec3<double>(0.03, 0.05, 0.06).asDiagonal() * R.transpose();
    s.model.joints[0].inertia = Inertia<double>::from_com(m, c, Ic);
    s.model.joints[0].axis.setUnit(1);
    s.model.joints[0].placement = {};
    s.base = {};
    finalize(s.model);
  }
  VectorXd qdd() const { return accelerations<double>(s, s.q, s.v, s.tau, s.gravity); }
};

VectorXd scalar(double x) { return VectorXd::Constant(1, x); }

// A pendulum hangs along -z and rotates about y: (I + m l^2) qdd = tau - m g l sin q.
TEST(Joints, Pendulum) {
  OneJoint joint(JointType::kRevolute);
  const double l = 0.8, g = 9.81;
  joint.s.model.joints[0].inertia = Inertia<double>::from_com(joint.m, {0, 0, -l}, joint.Ic);
  joint.s.gravity << 0, 0, -g;
  for (double q : {-2.0, 0.0, 0.3, 1.5, 3.0}) {
    joint.s.q = scalar(q);
    const double expected = (joint.s.tau[0] - joint.m * g * l * std::sin(q)) / (joint.Ic(1, 1) + joint.m * l * l);
    EXPECT_NEAR(joint.qdd()[0], expected, kTight * std::abs(expected)) << q;
  }
}

TEST(Joints, PrismaticWithArmature) {
  OneJoint joint(JointType::kPrismatic);
  joint.s.model.joints[0].axis = Vec3<double>(1, 2, -2) / 3;
  finalize(joint.s.model);
  joint.s.model.armature[0] = 0.4;
  const double along = joint.m * joint.s.gravity.dot(joint.s.model.joints[0].axis);
  EXPECT_NEAR(joint.qdd()[0], (joint.s.tau[0] + along) / (joint.m + 0.4), kTight);
  Kinematics<double> kin(joint.s.model);
  forward_kinematics<double>(joint.s.model, joint.s.base, joint.s.q, kin);
  EXPECT_LE(difference_of(kin.origin(0), Vec3<double>(joint.s.q[0] * joint.s.model.joints[0].axis)), kEps);
  EXPECT_EQ(kin.oMi[0].R, Mat3<double>::Identity());
}

// m (vdot + w x v) = f + R^T m g and Euler's I wdot + w x I w = n are valid about the centre of mass.
TEST(Joints, FreeBodyFollowsNewtonAndEuler) {
  const OneJoint joint(JointType::kFloating, true);
  const Specimen& s = joint.s;
  const Mat3<double> R = rotation_of_quaternion<double>(s.q[3], s.q[4], s.q[5], s.q[6]);
  const Vec3<double> v = s.v.head<3>(), w = s.v.tail<3>(), f = s.tau.head<3>(), n = s.tau.tail<3>();
  Vec6<double> expected;
  expected << Vec3<double>(f / joint.m + R.transpose() * s.gravity - w.cross(v)),
      Vec3<double>(joint.Ic.inverse() * (n - w.cross(Vec3<double>(joint.Ic * w))));
  EXPECT_LE(error_of(joint.qdd(), expected), kTight);
}

// The joint is away from the centre of mass, about which Newton and Euler's equations are then written.
TEST(Joints, FreeBodyOffItsCentreOfMass) {
  const OneJoint joint(JointType::kFloating);
  const Specimen& s = joint.s;
  const Mat3<double> R = rotation_of_quaternion<double>(s.q[3], s.q[4], s.q[5], s.q[6]);
  const VectorXd qdd = joint.qdd();
  const Vec3<double> v = s.v.head<3>(), w = s.v.tail<3>(), vdot = qdd.head<3>(), wdot = qdd.tail<3>();
  const Vec3<double> f = s.tau.head<3>(), n = s.tau.tail<3>(), c = joint.c;
  const Vec3<double> ac = vdot + w.cross(v) + wdot.cross(c) + w.cross(w.cross(c));
  EXPECT_LE(difference_of(Vec3<double>(joint.m * ac), Vec3<double>(f + joint.m * (R.transpose() * s.gravity))),
            16 * kTight);
  EXPECT_LE(
      difference_of(Vec3<double>(joint.Ic * wdot + w.cross(Vec3<double>(joint.Ic * w))), Vec3<double>(n - c.cross(f))),
      16 * kTight);
}

// q = x, y, theta; v and tau in the moving frame. In the plane, with the centre of mass at c:
// m (p'' + d^2/dt^2 R c) = R f + m g, I_zz theta'' = n - c x f.
TEST(Joints, PlanarBody) {
  const OneJoint joint(JointType::kPlanar);
  const Specimen& s = joint.s;
  const Eigen::Rotation2Dd R(s.q[2]);
  const VectorXd qdd = joint.qdd();
  const double w = s.v[2];
  const auto turn = [](const Eigen::Vector2d& x) { return Eigen::Vector2d(-x[1], x[0]); };
  const Eigen::Vector2d v = s.v.head<2>(), f = s.tau.head<2>(), c = joint.c.head<2>();
  const Eigen::Vector2d ac = qdd.head<2>() + w * turn(v) + qdd[2] * turn(c) - w * w * c;
  const Eigen::Vector2d force = f + joint.m * (R.inverse() * s.gravity.head<2>());
  EXPECT_LE(difference_of(Eigen::Vector2d(joint.m * ac), force), kTight * size_of(force));
  EXPECT_NEAR(joint.Ic(2, 2) * qdd[2], s.tau[2] - (c[0] * f[1] - c[1] * f[0]), kTight * size_of(force));

  Kinematics<double> kin(s.model);
  forward_kinematics<double>(s.model, s.base, s.q, kin);
  EXPECT_LE(difference_of(kin.origin(0), Vec3<double>(s.q[0], s.q[1], 0)), kEps);
  EXPECT_LE(difference_of(kin.oMi[0].R, rotation_about<double>(Vec3<double>::UnitZ(), s.q[2])), kEps);
}

TEST(Joints, RevoluteTurnsAboutAnyAxis) {
  OneJoint joint(JointType::kRevolute);
  for (const Vec3<double>& axis : {Vec3<double>(1, 0, 0), Vec3<double>(0, 1, 0), Vec3<double>(0, 0, 1),
                                   Vec3<double>(0, 0, -1), Vec3<double>(2, -1, 2)}) {
    Model& model = joint.s.model;
    model.joints[0].axis = axis.normalized();
    model.joints[0].placement = random_placement(joint.s.rng);
    finalize(model);
    Kinematics<double> kin(model);
    forward_kinematics<double>(model, joint.s.base, joint.s.q, kin);
    const SE3<double> turned{rotation_about<double>(axis.normalized(), joint.s.q[0]), Vec3<double>::Zero()};
    EXPECT_LE(difference_of(SE3<double>{kin.oMi[0].R, kin.origin(0)}, model.joints[0].placement * turned), 4 * kEps);
  }
}

// Two links in the x-z plane rotate about y: this is the textbook's double pendulum with point masses.
TEST(Joints, DoublePendulum) {
  const double l1 = 0.7, l2 = 0.5, m1 = 1.3, m2 = 0.8, g = 9.81;
  Model model;
  model.joints.resize(2);
  for (Joint& joint : model.joints) joint.axis.setUnit(1);
  model.joints[1].parent = 0;
  model.joints[1].placement.p << 0, 0, -l1;
  model.joints[0].inertia = Inertia<double>::from_com(m1, {0, 0, -l1}, Mat3<double>::Zero());
  model.joints[1].inertia = Inertia<double>::from_com(m2, {0, 0, -l2}, Mat3<double>::Zero());
  finalize(model);
  Specimen s({.njoints = 2, .types = {JointType::kRevolute}});
  s.model = model;
  s.base = {};

  const double q1 = s.q[0], q2 = s.q[1], v1 = s.v[0], v2 = s.v[1];
  const double coupling = m2 * l1 * l2;
  Eigen::Matrix2d M;
  M(1, 1) = m2 * l2 * l2;
  M(0, 1) = M(1, 0) = M(1, 1) + coupling * std::cos(q2);
  M(0, 0) = (m1 + m2) * l1 * l1 + M(1, 1) + 2 * coupling * std::cos(q2);
  const double coriolis = coupling * std::sin(q2);
  Eigen::Vector2d h(-coriolis * (2 * v1 * v2 + v2 * v2), coriolis * v1 * v1);
  h[1] += m2 * g * l2 * std::sin(q1 + q2);
  h[0] += (m1 + m2) * g * l1 * std::sin(q1) + m2 * g * l2 * std::sin(q1 + q2);

  EXPECT_LE(error_of(inertia_matrix<double>(s, s.q), M), kTight);
  EXPECT_LE(error_of(torques<double>(s, s.q, s.v, VectorXd::Zero(2), {0, 0, -g}), h), kTight);
}

}  // namespace
}  // namespace manycontact::test
