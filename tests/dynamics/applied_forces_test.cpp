// ExternalWrenches and springs are compared with torques written out and with the truth. Bounds, memory and refused
// input are tested too.

#include <gtest/gtest.h>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/dynamics/batch.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/allocations.hpp"
#include "support/applied.hpp"
#include "support/measure.hpp"
#include "support/methods.hpp"
#include "support/truth.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

RandomScene pushed_scene(int seed) {
  std::mt19937 rng(seed);
  SceneOptions options;
  options.nrobots = 1 + seed % 3;
  options.ncontacts = 5;
  RandomScene s = random_scene(rng, options);
  add_random_forces(s.scene, rng);
  return s;
}

Scene without_forces(Scene scene) {
  scene.wrenches.clear();
  scene.springs.clear();
  scene.joint_springs.clear();
  return scene;
}

// Placement, velocity and Jacobian (6 x nv of the scene) of an attachment, in the world's axes at its origin.
struct Point {
  SE3<double> place;
  Vec6<double> velocity = Vec6<double>::Zero();
  MatrixXd J;

  Point(const RandomScene& s, const Attachment& at) : J(MatrixXd::Zero(6, s.scene.nv)) {
    place = at.placement;
    if (at.robot < 0) return;
    const Robot& robot = s.scene.robots[at.robot];
    const Model& model = *robot.model;
    Kinematics<double> kin(model);
    forward_kinematics<double>(model, robot.base, s.q.segment(robot.idx_q, model.nq), kin);
    forward_accelerations<double>(model, s.v.segment(robot.idx_v, model.nv), nullptr, Vec3<double>::Zero(), kin);
    const ReferenceFrame axes = ReferenceFrame::kLocalWorldAligned;
    place = frame_placement<double>(kin, robot.base, at.joint, at.placement);
    velocity = frame_velocity<double>(kin, robot.base, at.joint, at.placement, axes);
    Mat6X<double> own(6, model.nv);
    frame_jacobian<double>(model, kin, robot.base, at.joint, at.placement, axes, own);
    J.middleCols(robot.idx_v, model.nv) = own;
  }
};

// Returns the torques of all forces, computed with Jacobians of frames.
VectorXd torques_of(const RandomScene& s) {
  VectorXd tau = VectorXd::Zero(s.scene.nv);
  for (const ExternalWrench& push : s.scene.wrenches) {
    const Point p(s, push.at);
    Vec6<double> w = push.wrench;
    if (push.reference_frame == ReferenceFrame::kLocal) w << p.place.R * w.head<3>(), p.place.R * w.tail<3>();
    tau += p.J.transpose() * w;
  }
  for (const Spring& spring : s.scene.springs) {
    const Point A(s, spring.A), B(s, spring.B);
    const Vec3<double> d = A.place.p - B.place.p, n = d.normalized();
    const double speed = n.dot(Vec3<double>((A.velocity - B.velocity).head<3>()));
    const Vec3<double> force = -(spring.stiffness * (d.norm() - spring.length) + spring.damping * speed) * n;
    tau += (A.J - B.J).topRows<3>().transpose() * force;
  }
  for (const JointSpring& spring : s.scene.joint_springs) {
    const Robot& robot = s.scene.robots[spring.robot];
    const Joint& joint = robot.model->joints[spring.joint];
    tau[robot.idx_v + joint.idx_v] -= spring.stiffness * (s.q[robot.idx_q + joint.idx_q] - spring.rest);
  }
  return tau;
}

TEST(AppliedForces, AreTorques) {
  for (int seed = 700; seed < 712; ++seed) {
    SCOPED_TRACE(seed);
    const RandomScene s = pushed_scene(seed);
    SceneData data(s.scene);
    (void)solve(s.scene, s.q, s.v, s.u, data);
    const Scene bare = without_forces(s.scene);
    SceneData other(bare);
    (void)solve(bare, s.q, s.v, s.u, other);
    const VectorXd expected = torques_of(s);
    EXPECT_LE(error_of(VectorXd(data.tau - other.tau), expected), 1e-12);
    (void)solve_tau(bare, s.q, s.v, VectorXd(other.tau + expected), other);
    EXPECT_LE(error_of(data.a, other.a), 1e-10);
    EXPECT_LE(error_of(data.f, other.f), 1e-10);
    EXPECT_GT(expected.norm(), 1);
    // the data of the scene with forces are valid for the one without
    (void)solve(bare, s.q, s.v, s.u, data);
    EXPECT_EQ(data.tau.norm(), other.tau.norm() > 0 ? data.tau.norm() : 0);
    (void)differentiate(bare, data);
    (void)solve(s.scene, s.q, s.v, s.u, data);
    EXPECT_LE(error_of(data.a, other.a), 1e-10);
  }
}

// Compares every method with the truth, and the errors with their bounds.
void expect_within_bounds(const RandomScene& s, double factor) {
  const std::vector<char> active = SceneData(s.scene).active;
  const Truth<Quad> truth = solve_truth<Quad>(s.scene, active, s.q.cast<Quad>(), s.v.cast<Quad>(), s.u.cast<Quad>());
  for (const Way& way : ways_here(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(s.scene, way.options);
    ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);
    if (factor > 0) {
      SceneData oracle(s.scene, {Method::kDense, {}});
      (void)solve(s.scene, s.q, s.v, s.u, oracle);
      EXPECT_LE(errors<Quad>(s.scene, data, truth.a, truth.f, conditions(s.scene, oracle)).excess, factor);
    }
    estimate_errors(s.scene, data);
    for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
      double error_a = 0, error_f = 0, size_a = 0, size_f = 0;
      const Island& island = solved_island(data, i);
      each_velocity_block(s.scene, island, [&](int at, int, int n) {
        for (int k = at; k < at + n; ++k) {
          error_a = std::max(error_a, static_cast<double>(abs(data.a[k] - truth.a[k])));
          size_a = std::max(size_a, std::abs(data.a[k]));
        }
      });
      each_force_block(s.scene, data.f_offset, island, [&](int at, int, int n) {
        for (int k = at; k < at + n; ++k) {
          error_f = std::max(error_f, static_cast<double>(abs(data.f[k] - truth.f[k])));
          size_f = std::max(size_f, std::abs(data.f[k]));
        }
      });
      const IslandReport& report = data.report.islands[i];
      EXPECT_LE(error_a, report.error_acceleration * size_a);
      EXPECT_LE(error_f, report.error_forces * size_f);
    }
  }
}

TEST(AppliedForces, AreTrueToTheBound) {
  for (int seed = 720; seed < 728; ++seed) {
    SCOPED_TRACE(seed);
    expect_within_bounds(pushed_scene(seed), 1);
  }
}

// ExternalWrenches cancel on one body, and springs are so stiff that rounding of positions counts. tau is a small
// difference of large numbers, which bounds have to include.
TEST(AppliedForces, BoundsKnowWhatCancels) {
  for (int seed = 730; seed < 738; ++seed) {
    SCOPED_TRACE(seed);
    RandomScene s = pushed_scene(seed);
    std::mt19937 rng(seed);
    ExternalWrench push = s.scene.wrenches[0];
    push.wrench = random_vector(6, rng, 1e9);
    push.name = "there";
    add_external_wrench(s.scene, push);
    push.wrench *= -1;
    push.name = "back";
    add_external_wrench(s.scene, push);
    Spring stiff = s.scene.springs[0];
    stiff.name = "stiff", stiff.stiffness = 1e10, stiff.damping = 0;
    stiff.length = (Point(s, stiff.A).place.p - Point(s, stiff.B).place.p).norm();
    add_spring(s.scene, stiff);
    expect_within_bounds(s, 0);
  }
}

TEST(AppliedForces, ChangeBetweenSolvesWithoutAllocations) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  RandomScene s = pushed_scene(741);
  for (const Way& way : ways_here()) {
    if (way.options.method == Method::kDenseSchur) continue;
    SCOPED_TRACE(way.name);
    SceneData data(s.scene, way.options);
    VectorXd dq = VectorXd::Ones(s.scene.nv), dw = VectorXd::Ones(static_cast<int>(6 * s.scene.wrenches.size()));
    VectorXd du = VectorXd::Ones(s.scene.nu), da = dq, df(data.f.size()), wq = dq, wv = dq, wu = du, ww = dw;
    const auto all = [&] {
      (void)solve(s.scene, s.q, s.v, s.u, data);
      (void)differentiate(s.scene, data, {true, true, true, true, false, true});
      jvp(s.scene, data, dq, dq, du, dw, da, df);
      vjp(s.scene, data, da, df, wq, wv, wu, ww);
    };
    all();
    const VectorXd before = data.a;
    data.wrenches[0] *= 2;
    s.scene.springs[0].stiffness *= 1.5;
    EXPECT_EQ(allocations(all), 0u);
    EXPECT_NE(data.a, before);
  }
}

TEST(AppliedForces, BatchesOfStates) {
  const RandomScene s = pushed_scene(750);  // one robot: states share a SIMD batch
  BatchData batch(s.scene, 1);
  for (Vec6<double>& w : batch.wrenches) w *= 3;
  const int n = 6;
  BatchMatrix Q(n, s.scene.nq), V(n, s.scene.nv), U(n, s.scene.nu);
  BatchMatrix A(n, s.scene.nv), F(n, force_rows(s.scene, batch));
  BatchMatrix D(n, (s.scene.nv + F.cols()) * (2 * s.scene.nv + s.scene.nu));
  std::mt19937 rng(1);
  for (int k = 0; k < n; ++k) {
    Q.row(k) = s.q;
    V.row(k) = random_vector(s.scene.nv, rng);
    U.row(k) = s.u;
  }
  std::vector<Status> status(n);
  differentiate_batch(s.scene, {Q, V, U}, batch, A, F, D, status);
  const BatchMatrix WA = BatchMatrix::Ones(n, A.cols()), WF = BatchMatrix::Ones(n, F.cols());
  BatchMatrix WQ = V, WV = V, WU = U, WW(n, 6 * s.scene.wrenches.size());
  vjp_batch(s.scene, {Q, V, U}, WA, WF, batch, WQ, WV, WU, WW, status);
  SceneData data(s.scene);
  data.wrenches = batch.wrenches;
  for (int k = 0; k < n; ++k) {
    (void)solve(s.scene, Q.row(k), V.row(k), U.row(k), data);
    EXPECT_EQ(A.row(k).transpose(), data.a);
    (void)differentiate(s.scene, data);
    const MatrixXd d(sparse_derivatives(s.scene, data));
    const Eigen::Map<const BatchMatrix> mine(D.row(k).data(), d.rows(), d.cols());
    EXPECT_LE((mine - d).cwiseAbs().maxCoeff(), 1e-11 * d.cwiseAbs().maxCoeff());
    VectorXd wq(WQ.cols()), wv(WV.cols()), wu(WU.cols()), ww(WW.cols());
    vjp(s.scene, data, WA.row(k), WF.row(k), wq, wv, wu, ww);
    EXPECT_GT(ww.norm(), 0);
    EXPECT_EQ(WQ.row(k).transpose(), wq);
    EXPECT_EQ(WW.row(k).transpose(), ww);
  }
}

// ---- scenes small enough to know the answer ------------------------------------------------------------------------

// Returns a mass that slides along z.
Model slider(double mass) {
  Model model;
  Joint joint;
  joint.name = "slide";
  joint.type = JointType::kPrismatic;
  joint.axis = Vec3<double>::UnitZ();
  joint.inertia = Inertia<double>::from_com(mass, Vec3<double>::Zero(), Mat3<double>::Identity());
  joint.lower = joint.upper = joint.velocity_limit = joint.effort_limit = VectorXd::Zero(1);
  model.joints = {joint};
  model.frames = {{"mass", 0, {}, false, {}, "slide"}};
  finalize(model);
  return model;
}

RandomScene two_sliders() {
  RandomScene s;
  const auto model = std::make_shared<const Model>(slider(2));
  add_robot(s.scene, "a", model);
  add_robot(s.scene, "b", model, {Mat3<double>::Identity(), {1, 0, 0}});
  s.q = s.v = VectorXd::Zero(2);
  s.u = VectorXd::Zero(2);
  return s;
}

TEST(AppliedForces, MassesOnSprings) {
  RandomScene s = two_sliders();
  add_spring(s.scene, {"up", attach(s.scene, "a", "mass"), {-1, -1, {Mat3<double>::Identity(), {0, 0, 3}}}, 50, 2, 4});
  add_joint_spring(s.scene, "b", "slide", 30, 0.5);
  s.v << 0.25, 0;
  SceneData data(s.scene);
  ASSERT_EQ(island_count(data), 2u);  // the world couples no robots
  (void)solve(s.scene, s.q, s.v, s.u, data);
  EXPECT_NEAR(data.a[0], -9.81 + (50 * (3 - 2) - 4 * 0.25) / 2, 1e-14);
  EXPECT_NEAR(data.a[1], -9.81 + 30 * 0.5 / 2, 1e-14);
  (void)differentiate(s.scene, data);
  const SceneDerivatives d = dense_derivatives(s.scene, data);
  EXPECT_NEAR(d.da_dq(0, 0), -25, 1e-13);
  EXPECT_NEAR(d.da_dv(0, 0), -2, 1e-14);
  EXPECT_NEAR(d.da_dq(1, 1), -15, 1e-14);
  EXPECT_EQ(d.da_dq(0, 1), 0);
}

TEST(AppliedForces, SpringsJoinRobotsToIslands) {
  RandomScene s = two_sliders();
  add_spring(s.scene, {"across", attach(s.scene, "a", "mass"), attach(s.scene, "b", "mass"), 50, 0.5, 0});
  s.q << 0, 0.75;  // 1.25 m apart
  for (const Way& way : ways_here(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(s.scene, way.options);
    ASSERT_EQ(island_count(data), 1u);
    ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);
    EXPECT_NEAR(data.a[0], -9.81 + 50 * 0.75 * 0.6 / 2, 1e-13);
    (void)differentiate(s.scene, data);
    EXPECT_GT(derivatives(data).islands[0].da_dq()(0, 1), 1);
    const Scene bare = without_forces(s.scene);  // two islands, solved with the same data
    (void)solve(bare, s.q, s.v, s.u, data);
    EXPECT_EQ(data.report.islands.size(), way.options.method == Method::kDenseSchur ? 1u : 2u);
    EXPECT_NEAR(data.a[0], -9.81, 1e-13);
  }
}

TEST(AppliedForces, EndsThatCoincideHaveNoDirection) {
  RandomScene s = two_sliders();
  const Attachment here{-1, -1, {}};
  add_spring(s.scene, {"smooth", attach(s.scene, "b", "mass"), {-1, -1, {Mat3<double>::Identity(), {1, 0, 0}}}, 50});
  add_spring(s.scene, {"none", attach(s.scene, "a", "mass"), here, 50, 1});
  SceneData data(s.scene);
  EXPECT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kFailed);
  EXPECT_EQ(data.report.islands[0].reason, Reason::kSpringWithoutDirection);
  EXPECT_EQ(data.report.islands[1].status, Status::kOk);
  EXPECT_NEAR(data.a[1], -9.81, 1e-14);
  (void)differentiate(s.scene, data, {true, true, true, true, false, true});
  EXPECT_TRUE(derivatives(data).islands[0].da_dq().array().isNaN().all());
  EXPECT_NEAR(derivatives(data).islands[1].da_dq()(0, 0), -25, 1e-13);
  s.q[0] = 1e-3;
  EXPECT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);
  s.q[0] = NAN;
  (void)solve(s.scene, s.q, s.v, s.u, data);
  EXPECT_EQ(data.report.islands[0].reason, Reason::kNotFinite);
}

// Quasi-static torques keep a robot at rest under gravity, wrenches and springs.
TEST(AppliedForces, QuasiStaticTorquesHold) {
  std::mt19937 rng(760);
  RandomScene s;
  add_robot(s.scene, "arm", std::make_shared<const Model>(random_model(rng, {.types = {JointType::kRevolute}})));
  s.q = random_configuration(*s.scene.robots[0].model, rng);
  s.v = VectorXd::Zero(s.scene.nv);
  add_random_forces(s.scene, rng);
  SceneData data(s.scene);
  for (Vec6<double>& w : data.wrenches) w *= 2;
  const VectorXd u = quasi_static(s.scene, s.q, data);
  (void)solve(s.scene, s.q, s.v, u, data);
  EXPECT_LE(data.a.cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_GT((u - quasi_static(without_forces(s.scene), s.q)).norm(), 1);
}

// ---- what is refused -----------------------------------------------------------------------------------------------

template <class Call>
std::string refusal(Call&& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(AppliedForces, WhatIsRefused) {
  RandomScene s = two_sliders();
  const Attachment a = attach(s.scene, "a", "mass"), b = attach(s.scene, "b", "mass");
  add_external_wrench(s.scene, {"wind", a});
  const auto push = [&](ExternalWrench p) { return refusal([&] { add_external_wrench(s.scene, p); }); };
  const auto spring = [&](Spring x) { return refusal([&] { add_spring(s.scene, x); }); };
  EXPECT_EQ(push({"wind", a}), "wrench 'wind' exists already, expected names used once");
  EXPECT_EQ(push({"x", {}}), "wrench 'x' is on the world, expected a body of a robot");
  EXPECT_EQ(push({"x", {0, -1, {}}}),
            "wrench 'x' is on the base of robot 'a', which cannot move, expected a body that moves");
  EXPECT_EQ(push({"x", {7, 0, {}}}), "wrench 'x' names robot 7, expected a number from -1 to 1");
  EXPECT_EQ(push({"x", a, ReferenceFrame::kLocal, Vec6<double>::Constant(NAN)}),
            "wrench 'x' has a force or torque that is not finite, expected finite numbers");
  EXPECT_EQ(spring({"s", a, b, -1}),
            "spring 's' has a stiffness that is not 0 or more, expected a finite number of 0 or more");
  EXPECT_EQ(spring({"s", a, b, 1, NAN}),
            "spring 's' has a length that is not 0 or more, expected a finite number of 0 or more");
  EXPECT_EQ(spring({"s", a, a, 1}),
            "spring 's' ties frame 'mass' of robot 'a' to frame 'mass' of robot 'a', which are on one body, expected "
            "two bodies");
  EXPECT_EQ(spring({"s", {0, -1, {}}, {}, 1}),
            "spring 's' has both ends where nothing can move, expected an end on a body that moves");
  EXPECT_EQ(spring({"s", {}, a, 1}), "");  // the ends are exchanged
  EXPECT_EQ(s.scene.springs[0].A.robot, 0);
  EXPECT_EQ(refusal([&] { add_joint_spring(s.scene, "a", "slide", -3); }),
            "joint 'slide' of robot 'a' has a stiffness that is not 0 or more, expected a finite number of 0 or more");
  EXPECT_NE(refusal([&] { add_joint_spring(s.scene, "a", "slip", 3); }), "");

  SceneData data(s.scene);
  data.wrenches.clear();
  EXPECT_EQ(refusal([&] { (void)solve(s.scene, s.q, s.v, s.u, data); }),
            "solve: data.wrenches has 0 wrenches, the scene has 1");
  data.wrenches.resize(1, Vec6<double>::Zero());
  Scene moved = s.scene;
  moved.wrenches[0].at = b;
  EXPECT_EQ(refusal([&] { (void)solve(moved, s.q, s.v, s.u, data); }),
            "solve: the data do not fit the scene: wrench 'wind' is on another body; make new data");
  moved = s.scene;
  moved.springs[0].stiffness = 7, moved.wrenches[0].at.placement.p.setOnes();
  EXPECT_EQ(refusal([&] { (void)solve(moved, s.q, s.v, s.u, data); }), "");
  add_external_wrench(moved, {"more", b});
  EXPECT_NE(refusal([&] { (void)solve(moved, s.q, s.v, s.u, data); }), "");
}

// Two robots share a SIMD batch. Meanwhile one is pushed, which widens its derivatives to all torques, and the other's
// contacts change. Together again they are differentiated as before.
TEST(AppliedForces, DerivativesOfRobotsSideBySideAreAsWideAgain) {
  std::mt19937 rng(4);
  ModelOptions options;
  options.njoints = 8;
  options.floating_base = true;
  options.branching = 0;
  const auto model = std::make_shared<const Model>(random_model(rng, options));
  RandomScene s;
  for (const char* name : {"a", "b"}) add_robot(s.scene, name, model);
  for (int r : {0, 1})
    for (int body : {3, 7}) {
      Contact c;
      c.name = "c" + std::to_string(r) + std::to_string(body);
      c.type = ContactType::k3D;
      c.A = {r, body, random_placement(rng, 0.1)};
      c.B.placement = random_placement(rng, 0.1);
      add_contact(s.scene, c);
    }
  ExternalWrench push{"push", {0, 2, random_placement(rng, 0.1)}};
  push.wrench = random_vector(6, rng, 5);
  add_external_wrench(s.scene, push);
  s.q.resize(s.scene.nq);
  for (const Robot& r : s.scene.robots) s.q.segment(r.idx_q, model->nq) = random_configuration(*model, rng);
  s.v = random_vector(s.scene.nv, rng, 0.5), s.u = random_vector(s.scene.nu, rng, 5);
  const Scene quiet = without_forces(s.scene);
  const auto padded = [](int columns) { return (columns + 7) / 8; };
  ASSERT_NE(padded(3 * model->nv), padded(2 * model->nv + model->nu()));
  SceneData data(s.scene), fresh(quiet);
  const auto differentiate_at = [&](const Scene& scene, SceneData& of) {
    ASSERT_EQ(solve(scene, s.q, s.v, s.u, of).status, Status::kOk);
    differentiate(scene, of);
  };
  differentiate_at(quiet, data);
  data.active[3] = 0;
  differentiate_at(s.scene, data);
  data.active[3] = 1;
  differentiate_at(quiet, data);
  differentiate_at(quiet, fresh);
  for (std::size_t i : {0, 1}) {
    const IslandDerivatives &x = derivatives(data).islands[i], &y = derivatives(fresh).islands[i];
    EXPECT_EQ(x.X.cols(), y.X.cols()) << i;
    EXPECT_TRUE(x.da_dq() == y.da_dq()) << i;
    EXPECT_TRUE(x.dforces_du() == y.dforces_du()) << i;
  }
}

}  // namespace
}  // namespace manycontact::test
