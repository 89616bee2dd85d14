// Dynamics, frames and quantities of a whole scene, of one of its robots and of a model agree with differences in
// quadruple precision and satisfy the laws of mechanics; misuse throws.

#include "manycontact/algorithm/rigid_body.hpp"

#include "algorithm/shapes.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/detail/algorithm/energy.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using VectorQ = VecX<Quad>;
using MatrixQ = MatX<Quad>;

constexpr double kClose = 1e-12;  // sums along chains of up to 60 links
constexpr ReferenceFrame kAllAxes[] = {ReferenceFrame::kLocal, ReferenceFrame::kWorld,
                                       ReferenceFrame::kLocalWorldAligned};
const Quad kDifference = Quad(1) / Quad(10000000000LL);

// The scene has three robots, the middle one of the current shape, with friction, and a state and forces.
class RigidBody : public testing::TestWithParam<Shape> {
 protected:
  RigidBody() {
    Shape shape = GetParam();
    rng.seed(shape.seed);
    shape.options.friction = 0.3;
    if (shape.options.armature == 0) shape.options.armature = 0.1;
    scene.gravity = {0.4, -0.7, -9.81};
    ModelOptions other;
    other.floating_base = true;
    add_robot(scene, "first", std::make_shared<Model>(random_model(rng, other)), random_placement(rng, 2));
    add_robot(scene, "middle", std::make_shared<Model>(random_model(rng, shape.options)), random_placement(rng, 2));
    add_robot(scene, "last", std::make_shared<Model>(random_model(rng)), random_placement(rng, 2));
    for (const Robot& robot : scene.robots) {
      q.conservativeResize(robot.idx_q + robot.model->nq);
      q.tail(robot.model->nq) = random_configuration(*robot.model, rng);
    }
    v = random_vector(scene.nv, rng);
    a = random_vector(scene.nv, rng);
    tau = random_vector(scene.nv, rng, 5);
    for (const Robot& robot : scene.robots)
      for (int i = 0; i < robot.model->njoints(); ++i) fext.push_back(random_vector(6, rng, 3));
  }

  // The state of robot r in quadruple precision, moved by t along (dq, dv).
  struct Moved {
    VectorQ q, v;
    Kinematics<Quad> kin;
  };
  Moved moved(const Robot& robot, const VectorQ& dq, const VectorQ& dv, const Quad& t, const VectorXd& acceleration) {
    const Model& model = *robot.model;
    Moved out{VectorQ(model.nq), own(v, robot).cast<Quad>() + t * dv, Kinematics<Quad>(model)};
    const VectorQ start = q.segment(robot.idx_q, model.nq).cast<Quad>();
    integrate<Quad>(model, start, VectorQ(t * dq), out.q);
    const VectorQ qdd = own(acceleration, robot).cast<Quad>();
    forward_kinematics<Quad>(model, robot.base, out.q, out.kin);
    forward_accelerations<Quad>(model, out.v, qdd.data(), scene.gravity, out.kin);
    return out;
  }
  static VectorXd own(const VectorXd& x, const Robot& robot) { return x.segment(robot.idx_v, robot.model->nv); }
  // Moves along the motion with acceleration a: dq = v t + a t^2 / 2.
  Moved along(const Robot& robot, const Quad& t) {
    const VectorQ qdd = own(a, robot).cast<Quad>(), rate = own(v, robot).cast<Quad>() + qdd * (t / 2);
    return moved(robot, rate, qdd, t, a);
  }
  // returns d of(t)/dt at 0
  template <class Of>
  static auto rate(Of&& of) {
    return ((of(kDifference) - of(-kDifference)) / (2 * kDifference)).eval();
  }

  std::mt19937 rng;
  Scene scene;
  VectorXd q, v, a, tau;
  std::vector<Vec6<double>> fext;
};

INSTANTIATE_TEST_SUITE_P(Of, RigidBody, testing::ValuesIn(shapes()), shape_name);

// ---- joint space ---------------------------------------------------------------------------------------------------

TEST_P(RigidBody, AbaUndoesRnea) {
  RigidBodyData data(scene);
  for (const bool pushed : {false, true}) {
    const ForcesOnBodies forces = pushed ? ForcesOnBodies(fext) : ForcesOnBodies();
    const VectorXd torques = rnea(scene, q, v, a, data, forces);
    const VectorXd back = aba(scene, q, v, torques, data, forces);
    for (const Robot& robot : scene.robots) {  // each as far as its own inertia allows
      const MatrixXd M = crba(scene, q, data).block(robot.idx_v, robot.idx_v, robot.model->nv, robot.model->nv);
      EXPECT_LE(error_of(own(back, robot), own(a, robot)), 100 * kEps * condition_1(M)) << robot.name;
    }
  }
}

TEST_P(RigidBody, TorquesAreMadeOfTheirParts) {
  RigidBodyData data(scene);
  const VectorXd zero = VectorXd::Zero(scene.nv);
  const VectorXd all = rnea(scene, q, v, a, data), h = nonlinear_effects(scene, q, v, data);
  const VectorXd g = gravity_torques(scene, q, data);
  const MatrixXd M = crba(scene, q, data), C = coriolis_matrix(scene, q, v, data);
  VectorXd friction = zero;
  for (const Robot& robot : scene.robots)
    if (has_friction(*robot.model)) add_friction(*robot.model, v.data() + robot.idx_v, friction.data() + robot.idx_v);
  EXPECT_GT(friction.norm(), 0.01);
  EXPECT_LE(error_of(VectorXd(M * a + h), all), kClose);
  EXPECT_LE(error_of(VectorXd(C * v + g - friction), h), kClose);
  EXPECT_EQ(VectorXd(nonlinear_effects(scene, q, zero, data)), g);
  for (int k = 0; k < scene.nv; ++k)  // M by RNEA, column by column
    EXPECT_LE(difference_of(VectorXd(rnea(scene, q, zero, VectorXd::Unit(scene.nv, k), data) - g), M.col(k)),
              kClose * std::max(size_of(M), size_of(g)));
}

TEST_P(RigidBody, InverseInertiaIsNeverFormed) {
  RigidBodyData data(scene);
  const MatrixXd X = MatrixXd::NullaryExpr(scene.nv, 3, [&] { return uniform(rng, -1, 1); });
  const MatrixXd Y = inverse_inertia_times(scene, q, X, data), M = crba(scene, q, data);
  for (const Robot& robot : scene.robots) {
    const int at = robot.idx_v, n = robot.model->nv;
    const MatrixXd block = M.block(at, at, n, n);
    EXPECT_LE(error_of(Y.middleRows(at, n), solved(block, X.middleRows(at, n))), 100 * kEps * condition_1(block));
  }
  EXPECT_EQ(M, VectorXd::Ones(scene.nv).asDiagonal() * MatrixXd(crba(scene, q, data)));  // it was not left factorized
}

// dM/dt - 2 C is skew, with dM/dt by differences.
TEST_P(RigidBody, CoriolisMatrixIsChristoffels) {
  RigidBodyData data(scene);
  const MatrixXd C = coriolis_matrix(scene, q, v, data);
  for (const Robot& robot : scene.robots) {
    const Model& model = *robot.model;
    const VectorQ still = VectorQ::Zero(model.nv);
    const MatrixQ rate_of_M = rate([&](const Quad& t) {
      const Moved at = moved(robot, own(v, robot).cast<Quad>(), still, t, a);
      std::vector<Inertia<Quad>> Yc;
      VectorQ packed(model.M_begin[model.nv]);
      manycontact::crba<Quad>(model, at.kin, Yc, packed.data());
      MatrixQ M(model.nv, model.nv);
      unpack_inertia<Quad>(model, packed.data(), M);
      return M;
    });
    const MatrixXd own_C = C.block(robot.idx_v, robot.idx_v, model.nv, model.nv);
    EXPECT_LE(difference_of(MatrixXd(own_C + own_C.transpose()), rate_of_M),
              kClose * std::max(1.0, size_of(rate_of_M)));
  }
}

// ---- derivatives ---------------------------------------------------------------------------------------------------

// Returns d f(q, v)/dq, dv of one robot from differences, with f in quadruple precision.
template <class F>
std::pair<MatrixQ, MatrixQ> by_differences(const Model& model, const VectorQ& q, const VectorQ& v, F&& f) {
  MatrixQ dq(model.nv, model.nv), dv(model.nv, model.nv);
  for (int k = 0; k < model.nv; ++k) {
    const auto at = [&](const Quad& h, bool of_q) {
      const VectorQ step = h * VectorQ::Unit(model.nv, k);
      VectorQ moved = q;
      if (of_q) integrate<Quad>(model, q, step, moved);
      return f(moved, of_q ? v : VectorQ(v + step));
    };
    dq.col(k) = (at(kDifference, true) - at(-kDifference, true)) / (2 * kDifference);
    dv.col(k) = (at(kDifference, false) - at(-kDifference, false)) / (2 * kDifference);
  }
  return {dq, dv};
}

TEST_P(RigidBody, DerivativesAreDifferences) {
  RigidBodyData data(scene);
  const TorqueDerivatives of_tau = rnea_derivatives(scene, q, v, a, data, fext);
  const AccelerationDerivatives of_a = aba_derivatives(scene, q, v, tau, data, fext);
  EXPECT_EQ(of_tau.da, crba(scene, q, data));
  const Robot& robot = scene.robots[1];  // the shape's, with friction
  const Model& model = *robot.model;
  std::vector<Vec6<Quad>> forces;
  const std::size_t first = static_cast<std::size_t>(scene.robots[0].model->njoints());
  for (int i = 0; i < model.njoints(); ++i) forces.push_back(fext[first + i].cast<Quad>());
  const VectorQ own_q = q.segment(robot.idx_q, model.nq).cast<Quad>(), own_v = own(v, robot).cast<Quad>();
  const auto block = [&](const MatrixXd& D) -> MatrixXd {
    return D.block(robot.idx_v, robot.idx_v, model.nv, model.nv);
  };
  Kinematics<Quad> kin(model);
  const auto torques = by_differences(model, own_q, own_v, [&](const VectorQ& q_, const VectorQ& v_) {
    std::vector<Vec6<Quad>> f;
    VectorQ out(model.nv);
    manycontact::rnea<Quad>(model, robot.base, q_, v_, own(a, robot).cast<Quad>(), scene.gravity, forces, kin, f, out);
    add_friction<Quad>(model, v_.data(), out.data(), -1);
    return out;
  });
  EXPECT_LE(error_of(block(of_tau.dq), torques.first), kClose);
  EXPECT_LE(error_of(block(of_tau.dv), torques.second), kClose);

  AbaData<Quad> memory(model);
  const auto accelerations = by_differences(model, own_q, own_v, [&](const VectorQ& q_, const VectorQ& v_) {
    VectorQ out(model.nv), driving = own(tau, robot).cast<Quad>();
    add_friction<Quad>(model, v_.data(), driving.data());
    EXPECT_TRUE(manycontact::aba<Quad>(model, robot.base, q_, v_, driving, scene.gravity, forces, kin, memory, out));
    return out;
  });
  const double allowed = 1000 * kEps * condition_1(block(of_tau.da)) + kClose;
  EXPECT_LE(error_of(block(of_a.dq), accelerations.first), allowed);
  EXPECT_LE(error_of(block(of_a.dv), accelerations.second), allowed);
  EXPECT_LE(error_of(block(of_a.dtau), inverse_of(block(of_tau.da))), allowed);
  MatrixXd apart = of_a.dq;  // nothing between robots
  for (const Robot& r : scene.robots) apart.block(r.idx_v, r.idx_v, r.model->nv, r.model->nv).setZero();
  EXPECT_EQ(apart.norm(), 0);
}

TEST_P(RigidBody, DerivativesOnTheManifold) {
  const VectorXd step = 0.3 * v, q1 = integrate(scene, q, step);
  const IntegrateDerivatives of_sum = integrate_derivatives(scene, q, step);
  const DifferenceDerivatives of_difference = difference_derivatives(scene, q, q1);
  const Robot& robot = scene.robots[1];
  const Model& model = *robot.model;
  const VectorQ from = q.segment(robot.idx_q, model.nq).cast<Quad>(), dq = own(step, robot).cast<Quad>();
  VectorQ to(model.nq);
  integrate<Quad>(model, from, dq, to);
  const auto add = [&](const VectorQ& x, const VectorQ& w) {
    VectorQ out(model.nq);
    integrate<Quad>(model, x, w, out);
    return out;
  };
  const auto subtract = [&](const VectorQ& x1, const VectorQ& x0) {
    VectorQ out(model.nv);
    difference<Quad>(model, x0, x1, out);
    return out;
  };
  const auto differences_of = [&](auto&& of) {
    MatrixQ out(model.nv, model.nv);
    for (int k = 0; k < model.nv; ++k)
      out.col(k) = rate([&](const Quad& h) { return VectorQ(of(VectorQ(h * VectorQ::Unit(model.nv, k)))); });
    return out;
  };
  const auto block = [&](const MatrixXd& D) -> MatrixXd {
    return D.block(robot.idx_v, robot.idx_v, model.nv, model.nv);
  };
  EXPECT_LE(
      error_of(block(of_sum.dq), differences_of([&](const VectorQ& h) { return subtract(add(add(from, h), dq), to); })),
      kClose);
  EXPECT_LE(error_of(block(of_sum.dv),
                     differences_of([&](const VectorQ& h) { return subtract(add(from, VectorQ(dq + h)), to); })),
            kClose);
  EXPECT_LE(
      error_of(block(of_difference.dq0), differences_of([&](const VectorQ& h) { return subtract(to, add(from, h)); })),
      kClose);
  EXPECT_LE(
      error_of(block(of_difference.dq1), differences_of([&](const VectorQ& h) { return subtract(add(to, h), from); })),
      kClose);
  EXPECT_LE(size_of(difference(scene, interpolate(scene, q, q1, 0), q)), kTight);
  EXPECT_LE(size_of(difference(scene, interpolate(scene, q, q1, 1), q1)), kTight);
  EXPECT_LE(difference_of(difference(scene, q, interpolate(scene, q, q1, 0.25)), VectorXd(0.25 * step)), kTight);
}

TEST_P(RigidBody, RandomVelocitiesKeepToLimits) {
  Model model = *scene.robots[1].model;
  model.joints[0].velocity_limit = VectorXd::Constant(model.joints[0].nv(), 7);
  double most = 0;
  for (int k = 0; k < 100; ++k) {
    const VectorXd x = random_velocity(model, rng);
    most = std::max(most, std::abs(x[0]));
    EXPECT_LE(size_of(x.head(model.joints[0].nv())), 7);
    EXPECT_LE(model.joints[0].nv() == model.nv ? 0 : size_of(x.tail(model.nv - model.joints[0].nv())), 1);
  }
  EXPECT_GT(most, 5);
}

// ---- frames --------------------------------------------------------------------------------------------------------

// In all axes the numbers of a frame's velocity are J v, and change by J a + (dJ/dt) v.
TEST_P(RigidBody, FramesMove) {
  RigidBodyData data(scene);
  forward_kinematics(scene, q, v, a, data);
  const Robot& robot = scene.robots[1];
  Attachment frame = find_frame(scene, "middle/link" + std::to_string(robot.model->njoints() - 1));
  frame.placement = random_placement(rng);
  for (const ReferenceFrame axes : kAllAxes) {
    const ReferenceFrame quads = axes == ReferenceFrame::kLocal   ? ReferenceFrame::kLocal
                                 : axes == ReferenceFrame::kWorld ? ReferenceFrame::kWorld
                                                                  : ReferenceFrame::kLocalWorldAligned;
    const auto velocity = [&](const Quad& t) {
      return frame_velocity<Quad>(along(robot, t).kin, robot.base, frame.joint, frame.placement, quads);
    };
    const Mat6X<double> J = frame_jacobian(scene, data, frame, axes);
    const Vec6<double> now = frame_velocity(scene, data, frame, axes),
                       drift = frame_bias_acceleration(scene, data, frame, axes);
    const Vec6<Quad> change = rate(velocity);
    const double size = std::max(size_of(change), size_of(J * a));
    EXPECT_LE(error_of(Vec6<double>(J * v), now), kClose);
    EXPECT_LE(error_of(now, velocity(0)), kClose);
    EXPECT_LE(difference_of(Vec6<double>(J * a + drift), change), kClose * size);
    const Vec6<double> acceleration = axes == ReferenceFrame::kLocalWorldAligned
                                          ? frame_classical_acceleration(scene, data, frame, axes)
                                          : frame_acceleration(scene, data, frame, axes);
    EXPECT_LE(difference_of(acceleration, change), kClose * size);
    EXPECT_GT(size_of(now), 1e-3);
  }
  const SE3<Quad> truth = frame_placement<Quad>(along(robot, 0).kin, robot.base, frame.joint, frame.placement);
  EXPECT_LE(difference_of(frame_placement(scene, data, frame), truth), 1e3 * kEps);

  forward_kinematics(scene, q, v, data);  // a = 0
  EXPECT_EQ(frame_bias_acceleration(scene, data, frame), frame_acceleration(scene, data, frame));
  forward_kinematics(scene, q, data);  // at rest
  EXPECT_EQ(frame_velocity(scene, data, frame).norm(), 0);
  EXPECT_EQ(frame_acceleration(scene, data, frame).norm(), 0);
  const Attachment world{-1, -1, frame.placement};
  EXPECT_EQ(frame_placement(scene, data, world).p, frame.placement.p);
  EXPECT_EQ(frame_jacobian(scene, data, world).norm(), 0);
}

// ---- the whole -----------------------------------------------------------------------------------------------------

TEST_P(RigidBody, MomentumIsMassTimesTheCentreOfMass) {
  RigidBodyData data(scene);
  forward_kinematics(scene, q, v, a, data);
  const Quad mass(total_mass(scene));
  const auto of_robots = [&](const Quad& t, auto&& of) {
    auto sum = of(scene.robots[0], along(scene.robots[0], t).kin);
    for (int r = 1; r < scene.nrobots(); ++r) sum += of(scene.robots[r], along(scene.robots[r], t).kin);
    return sum;
  };
  const auto center = [&](const Quad& t) -> Vec3<Quad> {
    return of_robots(t,
                     [](const Robot& robot, const Kinematics<Quad>& kin) -> Vec3<Quad> {
                       return Quad(robot.model->mass()) * center_of_mass<Quad>(kin);
                     }) /
           mass;
  };
  const auto momentum_about_center = [&](const Quad& t) -> Vec6<Quad> {
    Vec6<Quad> h =
        of_robots(t, [](const Robot&, const Kinematics<Quad>& kin) -> Vec6<Quad> { return momentum<Quad>(kin); });
    const Vec3<Quad> l = h.head<3>();
    h.tail<3>() -= center(t).cross(l);
    return h;
  };
  EXPECT_LE(error_of(center_of_mass(scene, data), center(0)), kClose);
  EXPECT_LE(error_of(center_of_mass_velocity(scene, data), rate(center)), kClose);
  const Vec3<Quad> curve = (center(kDifference) - 2 * center(0) + center(-kDifference)) / (kDifference * kDifference);
  EXPECT_LE(difference_of(center_of_mass_acceleration(scene, data), curve), 1e-10 * std::max(1.0, size_of(curve)));
  EXPECT_LE(error_of(Vec3<double>(center_of_mass_jacobian(scene, data) * v), center_of_mass_velocity(scene, data)),
            kClose);

  const Vec6<Quad> h = momentum_about_center(0), dh = rate(momentum_about_center);
  EXPECT_LE(error_of(centroidal_momentum(scene, data), h), kClose);
  EXPECT_LE(error_of(Vec6<double>(centroidal_momentum_matrix(scene, data) * v), h), kClose);
  EXPECT_LE(error_of(centroidal_momentum_rate(scene, data), dh), kClose);
}

// The rate of momentum is the weight plus the forces of the world on the root joints, joint_wrench of the roots.
TEST_P(RigidBody, RateOfMomentumIsTheSumOfOuterForces) {
  RigidBodyData data(scene);
  (void)rnea(scene, q, v, a, data);
  const Vec3<double> c = center_of_mass(scene, data);
  Vec6<double> outer = Vec6<double>::Zero();
  outer.head<3>() = total_mass(scene) * scene.gravity;
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints) {
      if (joint.parent >= 0) continue;
      const Attachment at = find_frame(scene, robot.name + "/link" + joint.name.substr(5));
      const SE3<double> from_center{Mat3<double>::Identity(), -c};
      outer += (from_center * frame_placement(scene, data, at))
                   .act_force(joint_wrench(scene, data, find_joint(scene, robot.name + "/" + joint.name)));
    }
  EXPECT_LE(difference_of(centroidal_momentum_rate(scene, data), outer), kClose * std::max(1.0, size_of(outer)));
  (void)gravity_torques(scene, q, data);
  EXPECT_EQ(centroidal_momentum_rate(scene, data).norm(), 0);
}

// Springs in joints are forces of a potential, as weight is, in torques, accelerations and derivatives.
TEST_P(RigidBody, SpringsInJointsAreAForceOfThePotential) {
  int springs = 0;
  for (const Joint& joint : scene.robots[1].model->joints)
    if (joint.nv() == 1 && springs < 3) add_joint_spring(scene, "middle", joint.name, 40.0 + 3 * springs++, 0.2);
  RigidBodyData data(scene);
  const VectorXd g = gravity_torques(scene, q, data), w = random_vector(scene.nv, rng, 1);
  constexpr double h = 1e-5;
  const auto potential = [&](double t) {
    forward_kinematics(scene, integrate(scene, q, VectorXd(t * w)), data);
    return potential_energy(scene, data);
  };
  const double rate = (8 * (potential(h) - potential(-h)) - potential(2 * h) + potential(-2 * h)) / (12 * h);
  EXPECT_NEAR(g.dot(w), rate, 1e-7 * (1 + std::abs(potential(0))));
  const VectorXd tau = rnea(scene, q, v, a, data, fext);
  EXPECT_LE(difference_of(aba(scene, q, v, tau, data, fext), a), 1e-8 * (1 + size_of(a)));
  const MatrixXd dq = rnea_derivatives(scene, q, v, a, data, fext).dq;
  const VectorXd before = rnea(scene, integrate(scene, q, VectorXd(-h * w)), v, a, data, fext);
  const VectorXd after = rnea(scene, integrate(scene, q, VectorXd(h * w)), v, a, data, fext);
  EXPECT_LE(difference_of(VectorXd(dq * w), VectorXd((after - before) / (2 * h))), 1e-4 * (1 + size_of(dq)));
  RigidBodyData alone{RigidBodies(scene, "middle")};
  const Robot& middle = scene.robots[1];
  EXPECT_LE(
      difference_of(gravity_torques(RigidBodies(scene, "middle"), q.segment(middle.idx_q, middle.model->nq), alone),
                    g.segment(middle.idx_v, middle.model->nv)),
      kClose * size_of(g));
}

// Along the joint the wrench is the torque, except for the rotor and friction, with forces on bodies too.
TEST_P(RigidBody, JointsCarryTheirTorque) {
  RigidBodyData data(scene);
  const VectorXd torques = rnea(scene, q, v, a, data, fext);
  int number = 0;
  for (const Robot& robot : scene.robots) {
    VectorXd expected = own(torques, robot) - robot.model->armature.cwiseProduct(own(a, robot));
    add_friction(*robot.model, v.data() + robot.idx_v, expected.data());
    for (int i = 0; i < robot.model->njoints(); ++i) {
      const Joint& joint = robot.model->joints[i];
      const Vec6<double> wrench = joint_wrench(scene, data, {number, i});
      Mat6X<double> S = Mat6X<double>::Zero(6, joint.nv());
      switch (joint.type) {
        case JointType::kRevolute:
          S.col(0).tail<3>() = joint.axis;
          break;
        case JointType::kPrismatic:
          S.col(0).head<3>() = joint.axis;
          break;
        case JointType::kFloating:
          S.setIdentity();
          break;
        case JointType::kPlanar:
          S(0, 0) = S(1, 1) = S(5, 2) = 1;
          break;
      }
      EXPECT_LE(difference_of(VectorXd(S.transpose() * wrench), expected.segment(joint.idx_v, joint.nv())),
                kClose * std::max(1.0, size_of(expected)));
    }
    ++number;
  }
}

TEST_P(RigidBody, EnergyIsKept) {  // power of the torques is the rate of energy
  RigidBodyData data(scene);
  const VectorXd torques = rnea(scene, q, v, a, data);
  VectorXd friction = VectorXd::Zero(scene.nv);
  for (const Robot& robot : scene.robots)
    add_friction(*robot.model, v.data() + robot.idx_v, friction.data() + robot.idx_v);
  const double h = 1e-5;
  const auto energy = [&](double t) {
    const VectorXd at = integrate(scene, q, t * v + t * t / 2 * a);
    forward_kinematics(scene, at, v + t * a, data);
    return kinetic_energy(scene, data) + potential_energy(scene, data);
  };
  const double power = (torques + friction).dot(v);
  EXPECT_NEAR((energy(h) - energy(-h)) / (2 * h), power, 1e-6 * (1 + std::abs(power) + torques.norm() * v.norm()));
}

// ---- one robot, and what is misused --------------------------------------------------------------------------------

TEST_P(RigidBody, OneRobotIsItsPartOfTheScene) {
  const RigidBodies one(scene, "middle");
  const Robot& robot = scene.robots[1];
  const Model& model = *robot.model;
  const VectorXd own_q = q.segment(robot.idx_q, model.nq);
  RigidBodyData all(scene), data(one), alone(RigidBodies(model, robot.base, scene.gravity));
  const VectorXd torques = own(rnea(scene, q, v, a, all), robot);
  EXPECT_EQ(VectorXd(rnea(one, own_q, own(v, robot), own(a, robot), data)), torques);
  EXPECT_EQ(VectorXd(rnea(RigidBodies(model, robot.base, scene.gravity), own_q, own(v, robot), own(a, robot), alone)),
            torques);
  const std::string link = "link" + std::to_string(model.njoints() - 1);
  const Attachment frame = find_frame(one, link);
  EXPECT_EQ(frame.robot, 1);
  EXPECT_EQ(find_frame(scene, "middle/" + link).joint, frame.joint);
  EXPECT_EQ(find_frame(model, link).robot, 0);
  EXPECT_EQ(frame_jacobian(one, data, frame), frame_jacobian(scene, all, frame).middleCols(robot.idx_v, model.nv));
  EXPECT_EQ(joint_wrench(one, data, find_joint(one, "joint0")),
            joint_wrench(scene, all, find_joint(scene, "middle/joint0")));
  EXPECT_EQ(frame_names(one).back(), link);
  EXPECT_EQ(joint_names(scene)[scene.robots[0].model->njoints()], "middle/joint0");
  EXPECT_EQ(neutral(one), VectorXd(neutral(scene).segment(robot.idx_q, model.nq)));
}

TEST_P(RigidBody, AllocatesNothingAfterTheFirstCall) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc is not ours to count";
  RigidBodyData data(scene);
  const auto all = [&] {
    (void)rnea(scene, q, v, a, data, fext);
    (void)nonlinear_effects(scene, q, v, data);
    (void)gravity_torques(scene, q, data);
    (void)aba(scene, q, v, tau, data, fext);
    (void)crba(scene, q, data);
    (void)rnea_derivatives(scene, q, v, a, data, fext);
    (void)aba_derivatives(scene, q, v, tau, data, fext);
    forward_kinematics(scene, q, v, a, data);
    (void)center_of_mass_velocity(scene, data);
    (void)centroidal_momentum_rate(scene, data);
  };
  all();
  EXPECT_EQ(allocations(all), 0u);
}

TEST(RigidBodies, SayWhatIsWrong) {
  std::mt19937 rng(2);
  Scene scene;
  const auto model = std::make_shared<Model>(random_model(rng)), other = std::make_shared<Model>(random_model(rng));
  add_robot(scene, "a", model);
  add_robot(scene, "b", model);
  RigidBodyData data(scene), of_other(*other);
  const VectorXd q = neutral(scene), v = VectorXd::Zero(scene.nv), few = v.head(2);
  EXPECT_THROW((void)rnea(scene, q, few, v, data), std::invalid_argument);
  EXPECT_THROW((void)rnea(scene, q, v, v, of_other), std::invalid_argument);
  EXPECT_THROW((void)aba(scene, q, v, v, data, std::vector<Vec6<double>>(3)), std::invalid_argument);
  EXPECT_THROW((void)inverse_inertia_times(scene, q, few, data), std::invalid_argument);
  EXPECT_THROW((void)RigidBodies(scene, "c"), std::invalid_argument);
  Model raw;
  raw.joints.resize(1);
  EXPECT_THROW((void)RigidBodies(raw), std::invalid_argument);
  const auto message = [](auto&& act) -> std::string {
    try {
      act();
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message([&] { (void)find_frame(scene, "link0"); }).find("expected robot/name"), std::string::npos);
  EXPECT_NE(message([&] { (void)find_frame(scene, "x/link0"); }).find("'a', 'b'"), std::string::npos);
  EXPECT_NE(message([&] { (void)find_frame(scene, "a/lnk0"); }).find("'link0'"), std::string::npos);
  EXPECT_NE(message([&] { (void)find_joint(scene, "a/knee"); }).find("'joint0'"), std::string::npos);
  EXPECT_NE(message([&] { (void)frame_velocity(scene, data, {7, 0, {}}); }).find("is not one of"), std::string::npos);
  EXPECT_THROW((void)joint_wrench(scene, data, {0, 0}), std::logic_error);
  (void)rnea(scene, q, v, v, data);
  EXPECT_NO_THROW((void)joint_wrench(scene, data, {0, 0}));
  (void)aba(scene, q, v, v, data);
  EXPECT_THROW((void)joint_wrench(scene, data, {0, 0}), std::logic_error);
}

TEST(RigidBodies, SingularInertiaIsNotANumber) {
  Specimen s({.njoints = 4, .types = {JointType::kRevolute}, .branching = 0});
  s.model.joints[3].inertia = {};
  RigidBodyData data(s.model);
  EXPECT_TRUE(aba(s.model, s.q, s.v, s.tau, data).array().isNaN().all());
  EXPECT_TRUE(inverse_inertia_times(s.model, s.q, s.tau, data).array().isNaN().all());
  EXPECT_TRUE(aba_derivatives(s.model, s.q, s.v, s.tau, data).dtau.array().isNaN().all());
  EXPECT_TRUE(rnea(s.model, s.q, s.v, s.qdd, data).allFinite());
}

}  // namespace
}  // namespace manycontact::test
