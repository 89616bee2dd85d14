// These quantities are zero up to rounding error, with nothing to compare them with: contacts of a point about which
// all joints rotate, inertia about an axis through all the mass, robots without joints.

#include <gtest/gtest.h>

#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "support/chains.hpp"
#include "support/measure.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/truth.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

// Returns a chain of revolute joints.
Model chain(std::mt19937& rng, int njoints) {
  ModelOptions options;
  options.njoints = njoints;
  options.types = {JointType::kRevolute};
  options.branching = options.coordinate_axes = options.plain_placements = 0;
  return random_model(rng, options);
}

Scene scene_of(const Model& model, std::mt19937& rng) {
  Scene scene;
  add_robot(scene, "robot", std::make_shared<Model>(model), random_placement(rng));
  return scene;
}

Contact contact_data(ContactType type, int joint, const SE3<double>& offset) {
  Contact c;
  c.name = "hold";
  c.type = type;
  c.A = {0, joint, offset};
  return c;
}

TEST(Vanishing, APointOnTheJointsAxisHoldsNothing) {
  std::mt19937 rng(401);
  for (int k = 0; k < 20; ++k) {
    const Model model = chain(rng, 1);
    Scene scene = scene_of(model, rng);
    Contact c = contact_data(ContactType::k3D, 0, {random_rotation(rng), 0.3 * model.joints[0].axis});
    const VectorXd q = random_vector(1, rng), v = VectorXd::Zero(1), u = random_vector(1, rng);
    resolve_reference(scene, q, true, true, c);
    add_contact(scene, c);
    const VectorXd expected = free_accelerations(scene, q, v, u);
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name);
      SceneData data(scene, way.options);
      (void)solve(scene, q, v, u, data);
      if (way.options.method == Method::kDenseSchur && data.report.status == Status::kFailed) continue;
      EXPECT_EQ(data.report.status, Status::kRedundant);
      EXPECT_EQ(data.report.rank, 0);
      EXPECT_LE(error_of(data.a, expected), 1e-12);
      EXPECT_LE(size_of(data.f), 1e-12);
    }
  }
}

TEST(Vanishing, APointMassOnTheJointsAxisHasNoInertiaAboutIt) {
  std::mt19937 rng(402);
  for (int k = 0; k < 40; ++k) {
    Model model = chain(rng, 1 + k % 4);
    Joint& last = model.joints.back();
    last.inertia = Inertia<double>::from_com(2, 0.3 * last.axis, Mat3<double>::Zero());
    const Scene scene = scene_of(model, rng);
    const int n = model.nv;
    const VectorXd q = random_vector(n, rng), v = random_vector(n, rng), u = random_vector(n, rng);
    for (const Way& way : ways(true)) {
      SceneData data(scene, way.options);
      (void)solve(scene, q, v, u, data);
      EXPECT_EQ(data.report.status, Status::kFailed) << way.name;
      EXPECT_EQ(data.report.islands[0].reason, Reason::kSingularInertia) << way.name;
    }
  }
}

// The point mass has none either where fixed bodies cut a tree into parts, the last of which has that joint.
TEST(Vanishing, APointMassOnTheLastJointsAxisOfAHeldChain) {
  for (int seed = 0; seed < 20; ++seed) {
    ChainOptions options;
    options.links = 35;
    Chain c = make_chain(options);
    Model model = *c.scene.robots[0].model;
    Joint& last = model.joints.back();
    last.inertia = Inertia<double>::from_com(2, 0.3 * last.axis, Mat3<double>::Zero());
    c.scene.robots[0].model = std::make_shared<const Model>(std::move(model));
    std::mt19937 rng(seed);
    c.q = random_vector(35, rng);
    for (const SimdLevel level : kSimdLevels) {
      const Options bodies{Method::kSparseBodies, {}, level};
      SceneData data(c.scene, bodies);
      (void)solve(c.scene, c.q, c.v, c.u, data);
      EXPECT_EQ(data.report.status, Status::kFailed) << seed << ' ' << to_string(level);
      EXPECT_EQ(data.report.islands[0].reason, Reason::kSingularInertia) << seed << ' ' << to_string(level);
    }
  }
}

TEST(Vanishing, APointMassOnThreeParallelJointsIsSingular) {
  std::mt19937 rng(408);
  for (int k = 0; k < 40; ++k) {
    Model model = chain(rng, 3);
    const Vec3<double> axis = model.joints[0].axis;
    for (Joint& joint : model.joints) joint.axis = axis, joint.placement.R.setIdentity(), joint.inertia = {};
    model.joints[2].inertia = Inertia<double>::from_com(2, {0.1, 0.2, 0.3}, Mat3<double>::Zero());
    finalize(model);
    const Scene scene = scene_of(model, rng);
    const VectorXd q = random_vector(3, rng), v = random_vector(3, rng), u = random_vector(3, rng);
    for (const Way& way : ways(true)) {
      SceneData data(scene, way.options);
      (void)solve(scene, q, v, u, data);
      EXPECT_EQ(data.report.status, Status::kFailed) << way.name;
    }
  }
}

TEST(Vanishing, ContactsThatDoNotHoldAMasslessLinkDoNotMakeItSoundByRounding) {
  std::mt19937 rng(403);
  for (int k = 0; k < 40; ++k) {
    Model model = chain(rng, 7);
    model.joints.back().inertia = {};
    Scene scene = scene_of(model, rng);
    const VectorXd q = random_vector(7, rng), v = random_vector(7, rng), u = random_vector(7, rng);
    Contact c = contact_data(ContactType::k6D, 5, random_placement(rng));
    resolve_reference(scene, q, true, true, c);
    add_contact(scene, c);
    if (k % 2) {
      c.name = "again";
      c.reference_frame = ReferenceFrame::kWorld;
      add_contact(scene, c);
    }
    for (const Way& way : ways(true)) {
      SceneData data(scene, way.options);
      EXPECT_EQ(solve(scene, q, v, u, data).status, Status::kFailed) << way.name;
    }
  }
}

// A torque accelerates a link with nearly no inertia by 1e13 and more. That is rounding of no contradiction.
TEST(Vanishing, LinksOfNearlyNoInertiaHideNoContradiction) {
  std::mt19937 rng(409);
  for (const double inertia : {1e-13, 1e-14})
    for (int k = 0; k < 10; ++k) {
      Model model = chain(rng, 3);
      model.joints.back().inertia =
          Inertia<double>::from_com(inertia, random_vector(3, rng), Mat3<double>(inertia * Mat3<double>::Identity()));
      finalize(model);
      Scene scene = scene_of(model, rng);
      const VectorXd q = random_vector(3, rng), v = VectorXd::Zero(3), u = random_vector(3, rng);
      Contact point = contact_data(ContactType::k3D, 2, random_placement(rng));
      point.alpha = 2500;
      resolve_reference(scene, q, true, true, point);
      add_contact(scene, point);
      point.name = "apart";
      point.B.placement.p += 0.02 * random_vector(3, rng);
      add_contact(scene, point);
      for (const bool pairs : {true, false})
        for (const Method method : {Method::kAuto, Method::kDense, Method::kSparseLdl, Method::kSparseBodies}) {
          Options options{method};
          options.reduce_pairs = pairs;
          SceneData data(scene, options);
          EXPECT_EQ(solve(scene, q, v, u, data).status, Status::kInconsistent)
              << to_string(method) << ' ' << pairs << ' ' << inertia << ' ' << k;
        }
    }
}

TEST(Vanishing, ASmallRowBeforeThoseThatDependOnItTakesNoDigits) {
  std::mt19937 rng(407);
  const Model model = chain(rng, 1);
  Contact point = contact_data(ContactType::k3D, 0, {random_rotation(rng), {0.3, 0.2, 0.1}});
  const VectorXd q = random_vector(1, rng), v = VectorXd::Zero(1), u = random_vector(1, rng);
  for (double small : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
    Scene scene = scene_of(model, rng);
    resolve_reference(scene, q, true, true, point);
    Scene alone = scene;
    add_contact(alone, point);
    const Vec3<double> moves = contact_jacobian(alone, q).col(0).normalized();
    Contact row = point;
    row.name = "row";
    row.type = ContactType::k1D;
    row.axis = moves.unitOrthogonal() + small * moves;
    add_contact(scene, row);
    add_contact(scene, point);
    const Truth<Quad> truth = solve_truth<Quad>(scene, {1, 1}, q.cast<Quad>(), v.cast<Quad>(), u.cast<Quad>());
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name + " " + testing::PrintToString(small));
      SceneData data(scene, way.options);
      (void)solve(scene, q, v, u, data);
      if (way.options.method == Method::kDenseSchur && data.report.status == Status::kFailed) continue;
      EXPECT_EQ(data.report.status, Status::kRedundant);
      EXPECT_LE(error_of(data.f, truth.f), 1e-12);
    }
  }
}

TEST(Vanishing, RoundingOfFastMotionIsNoContradiction) {
  std::mt19937 rng(404);
  for (int k = 0; k < 20; ++k) {  // a point of a rotating body does not move along the axis
    const Model model = chain(rng, 1);
    Scene scene = scene_of(model, rng);
    Contact c = contact_data(ContactType::k1D, 0, {Mat3<double>::Identity(), random_vector(3, rng)});
    c.axis = model.joints[0].axis;
    const VectorXd q = random_vector(1, rng), v = VectorXd::Constant(1, 1e4), u = random_vector(1, rng);
    resolve_reference(scene, q, true, true, c);
    add_contact(scene, c);
    for (const Way& way : ways(true)) {
      SceneData data(scene, way.options);
      (void)solve(scene, q, v, u, data);
      if (way.options.method == Method::kDenseSchur && data.report.status == Status::kFailed) continue;
      EXPECT_EQ(data.report.status, Status::kRedundant) << way.name;
    }
  }
}

// Straight arms are constrained at their tips along themselves: their joints do not move the rows that contacts-early
// puts behind these joints. These rows wait, and join.
TEST(Vanishing, RowsThatContactsEarlyPlacesTooEarlyWait) {
  Model model;
  for (int arm = 0; arm < 3; ++arm)
    for (int k = 0; k < 3; ++k) {
      if (arm == 0 && k > 0) break;  // the body
      Joint joint;
      joint.type = arm == 0 ? JointType::kFloating : JointType::kRevolute;
      joint.parent = arm == 0 ? -1 : k == 0 ? 0 : model.njoints() - 1;
      if (arm > 0 && k == 0) {
        const double angle = 1.5 * arm;
        joint.placement.R << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
      }
      joint.placement.p[0] = arm == 0 ? 0 : 2;
      joint.axis = Vec3<double>::UnitZ();
      joint.inertia = Inertia<double>::from_com(1, {0.1, 0.02, 0.03}, Mat3<double>::Identity());
      model.joints.push_back(joint);
    }
  finalize(model);
  Scene scene;
  add_robot(scene, "spider", std::make_shared<Model>(model));
  for (int arm = 0; arm < 2; ++arm) {
    Contact c;
    c.name = "tip" + std::to_string(arm);
    c.type = ContactType::k1D;
    c.axis = Vec3<double>::UnitX();
    c.A = {0, 3 * arm + 3, {}};
    c.A.placement.p[0] = 1;
    add_contact(scene, c);
  }
  const Eigen::VectorXd q = neutral(model), v = Eigen::VectorXd::Zero(model.nv), u = Eigen::VectorXd::Ones(scene.nu);
  SceneData early(scene, {Method::kSparseLdl, Order::kContactsEarly, SimdLevel::kOff});
  SceneData last(scene, {Method::kSparseLdl, Order::kLeafToRoot, SimdLevel::kOff});
  ASSERT_EQ(solve(scene, q, v, u, last).status, Status::kOk);
  ASSERT_EQ(solve(scene, q, v, u, early).status, Status::kOk);
  const IslandReport& report = early.report.islands[0];
  EXPECT_FALSE(report.changed_order);
  EXPECT_EQ(report.method, Method::kSparseLdl);
  EXPECT_EQ(report.order, Order::kContactsEarly);
  EXPECT_EQ(report.reason, Reason::kNone);
  EXPECT_LE(relative(early.a, last.a), 1e-14);
  EXPECT_LE(relative(early.f, last.f), 1e-14);
}

TEST(Vanishing, ARobotWithoutJointsIsSolvedAndDifferentiated) {
  std::mt19937 rng(405);
  Model object;
  object.name = "object";
  finalize(object);
  for (ContactType type : {ContactType::k1D, ContactType::k3D})
    for (bool held : {false, true}) {  // the object constrains the last link of the chain
      Scene scene = scene_of(chain(rng, 3), rng);
      add_robot(scene, "object", std::make_shared<Model>(object), {});
      Contact c = contact_data(type, -1, random_placement(rng));
      c.A.robot = 1;
      c.B = {0, 2, random_placement(rng)};
      if (held) add_contact(scene, c);
      const VectorXd q = random_vector(3, rng), v = random_vector(3, rng), u = random_vector(3, rng);
      for (const Way& way : ways(true)) {
        SCOPED_TRACE(way.name);
        SceneData data(scene, way.options);
        const Status status = solve(scene, q, v, u, data).status;
        EXPECT_EQ(status, Status::kOk);
        differentiate(scene, data);
        const SceneDerivatives d = dense_derivatives(scene, data);
        EXPECT_TRUE(d.da_dq.allFinite());
        EXPECT_EQ(d.da_dq.rows(), 3);
        EXPECT_EQ(d.dforces_dq.rows(), held ? contact_rows(type) : 0);
      }
    }
}

TEST(Vanishing, BoundsOfErrorsDoNotDependOnWhatWasAskedBefore) {
  std::mt19937 rng(406);
  for (int k = 0; k < 5; ++k) {
    SceneOptions options;
    options.redundant = k % 2;
    const RandomScene s = random_scene(rng, options);
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name);
      SceneData data(s.scene, way.options);
      if (solve(s.scene, s.q, s.v, s.u, data).status == Status::kFailed) continue;
      estimate_errors(s.scene, data);
      const Report before = data.report;
      differentiate(s.scene, data);
      const int nv = s.scene.nv, nu = s.scene.nu, nc = static_cast<int>(data.f.size());
      VectorXd a(nv), f(nc), q(nv), v(nv), u(nu);
      jvp(s.scene, data, random_vector(nv, rng), random_vector(nv, rng), random_vector(nu, rng), a, f);
      vjp(s.scene, data, a, f, q, v, u);
      estimate_errors(s.scene, data);
      EXPECT_EQ(data.report.error_acceleration, before.error_acceleration);
      EXPECT_EQ(data.report.error_forces, before.error_forces);
    }
  }
}

// The rows of J are the relative motion at A's frame: the place of B's frame on its body affects the placement error
// alone.
TEST(Vanishing, AFrameFarAwayOnBLeavesRowsAsTheyAre) {
  std::mt19937 rng(407);
  for (const ContactType type : {ContactType::k1D, ContactType::k2D, ContactType::k3D}) {
    Scene scene = scene_of(chain(rng, 4), rng);
    add_robot(scene, "other", std::make_shared<Model>(chain(rng, 4)), random_placement(rng));
    Contact c = contact_data(type, 3, random_placement(rng));
    c.axis = random_vector(3, rng).normalized();
    c.B = {1, 3, {random_rotation(rng), 1e20 * random_vector(3, rng)}};
    add_contact(scene, c);
    const VectorXd q = random_vector(8, rng), v = random_vector(8, rng), u = random_vector(8, rng);
    for (const Way& way : ways_here(true)) {
      SCOPED_TRACE(way.name);
      SceneData data(scene, way.options);
      EXPECT_EQ(solve(scene, q, v, u, data).status, Status::kOk);
      EXPECT_EQ(data.report.rank, contact_rows(type));
    }
  }
}

// The same row is there twice, a million metres away and in other axes, and a contact is nearby. Rounding of J, 1e6
// eps, rotates the null space by as much towards this contact: the least norm takes that part of its forces.
TEST(Vanishing, BoundsHoldForForcesOfLeastNormBesideLargeOnes) {
  std::mt19937 rng(408);
  for (int k = 0; k < 20; ++k) {
    ModelOptions options;
    options.floating_base = true;
    options.njoints = 2;
    const Model model = random_model(rng, options);
    Scene scene;
    add_robot(scene, "robot", std::make_shared<Model>(model));
    const VectorXd q = random_configuration(model, rng);
    const VectorXd v = VectorXd::Zero(scene.nv), u = random_vector(scene.nu, rng);
    Contact far = contact_data(ContactType::k1D, 0, {Mat3<double>::Identity(), 1e6 * random_vector(3, rng)});
    far.axis = random_vector(3, rng).normalized();
    add_contact(scene, far);
    far.name = "again";
    far.reference_frame = ReferenceFrame::kWorld;
    const Eigen::Vector4d r = q.segment<4>(3);
    far.axis = rotation_of_quaternion(r[0], r[1], r[2], r[3]) * far.axis;
    add_contact(scene, far);
    Contact near = contact_data(ContactType::k3D, 0, random_placement(rng));
    near.name = "near";
    add_contact(scene, near);
    const Truth<Quad> truth = solve_truth<Quad>(scene, {1, 1, 1}, q.cast<Quad>(), v.cast<Quad>(), u.cast<Quad>());
    const VectorXd a = truth.a.cast<double>(), f = truth.f.cast<double>();
    for (const Way& way : ways(true)) {
      if (way.options.method == Method::kDenseSchur) continue;  // it detects no dependent rows
      SCOPED_TRACE(way.name + " " + std::to_string(k));
      SceneData data(scene, way.options);
      EXPECT_EQ(solve(scene, q, v, u, data).status, Status::kRedundant);
      estimate_errors(scene, data);
      EXPECT_LE(size_of(data.a - a), data.report.error_acceleration * size_of(data.a));
      EXPECT_LE(size_of(data.f - f), data.report.error_forces * size_of(data.f));
    }
  }
}

}  // namespace
}  // namespace manycontact::test
