// A solution is checked beyond its status: placements, pressure, limits, inconsistency, masses.

#include "manycontact/analysis/findings.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "manycontact/dynamics/solve.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

const std::string kBox = "<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\" xyz=\"1 2 3\"/>";

SceneFile held(const std::string& contact) { return load_text("<scene>" + kBox + contact + "</scene>"); }

std::vector<PlacementError> errors_of(const SceneFile& file) {
  std::vector<char> active;
  for (const Contact& contact : file.scene.contacts) active.push_back(contact.active);
  return placement_errors(file.scene, file.q, active);
}

TEST(PlacementErrors, OfEveryType) {
  const auto error = [](const std::string& type, const std::string& more) {
    const auto found = errors_of(held("<contact name=\"c\" type=\"" + type + "\" frame=\"b/crate\" " + more + "/>"));
    return found.empty() ? PlacementError{-1} : found[0];
  };
  const std::string away = "xyz=\"1 2 8\" quat_xyzw=\"0 0 0 1\"";  // 5 m below its reference
  EXPECT_NEAR(error("3d", away).position, 5, 1e-12);
  EXPECT_EQ(error("3d", away).angle, 0);
  EXPECT_NEAR(error("1d", away + " axis=\"0 3 4\"").position, 4, 1e-12);
  EXPECT_NEAR(error("2d", away).position, 5, 1e-12);
  EXPECT_EQ(error("2d", "xyz=\"1 7 3\"").contact, -1);  // y is free
  EXPECT_EQ(error("1d", "xyz=\"1 2 8\" axis=\"1 0 0\"").contact, -1);
  // rotated by 0.8 about x
  const std::string turned = "quat_xyzw=\"0.3894183423086505 0 0 0.9210609940028851\"";
  EXPECT_NEAR(error("6d", turned).angle, 0.8, 1e-12);
  EXPECT_LT(error("6d", turned).position, 1e-12);
  EXPECT_NEAR(error("5d", turned + " axis=\"0 1 0\"").angle, 0.8, 1e-12);
  EXPECT_EQ(error("5d", turned + " axis=\"1 0 0\"").contact, -1);  // about the hinge's axis
  EXPECT_EQ(error("6d", "").contact, -1);
  EXPECT_EQ(error("3d", "xyz=\"1 2 3.0000005\"").contact, -1);  // files round as much
  EXPECT_TRUE(
      errors_of(held("<contact name=\"c\" type=\"3d\" frame=\"b/crate\" xyz=\"0 0 0\" active=\"false\"/>")).empty());
}

// The distance is that of the frames in the world, whatever robots are between them.
TEST(PlacementErrors, BetweenRobots) {
  const SceneFile file = load_text(
      "<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\" copies=\"3\" spacing=\"2\"/>"
      "<contact name=\"c\" type=\"3d\" frame=\"b/crate\" to=\"b+1/crate\" to_offset=\"0.5 0 0\"/></scene>");
  const auto found = errors_of(file);
  ASSERT_EQ(found.size(), 2u);
  for (const PlacementError& e : found) EXPECT_NEAR(e.position, 2.5, 1e-12);
}

Scene one_contact(ContactType type, double mu, const Eigen::Vector2d& box = Eigen::Vector2d::Zero()) {
  SceneFile file = held("<contact name=\"c\" type=\"6d\" frame=\"b/crate\"/>");
  file.scene.contacts[0].type = type;
  file.scene.contacts[0].mu = mu;
  file.scene.contacts[0].box = box;
  return file.scene;
}

std::vector<Violation> judged(const Scene& scene, std::initializer_list<double> force) {
  const std::vector<double> f(force);
  return violations(scene, neutral(*scene.robots[0].model),
                    Eigen::Map<const Eigen::VectorXd>(f.data(), static_cast<Eigen::Index>(f.size())), {0});
}

TEST(Violations, PullAndSlip) {
  const Scene point = one_contact(ContactType::k3D, 0.5);
  EXPECT_TRUE(judged(point, {3, 4, 10}).empty());  // |t| = 5 = mu n
  auto found = judged(point, {6, 8, 10});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, ViolationKind::kSlips);
  EXPECT_NEAR(found[0].by, 5, 1e-12);
  EXPECT_NEAR(found[0].needs, 1, 1e-12);
  found = judged(point, {6, 8, -10});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, ViolationKind::kPulls);
  EXPECT_NEAR(found[0].by, 10, 1e-12);
  EXPECT_TRUE(judged(one_contact(ContactType::k1D, 0), {1}).empty());
  EXPECT_EQ(judged(one_contact(ContactType::k1D, 0), {-1}).at(0).kind, ViolationKind::kPulls);
  EXPECT_EQ(judged(one_contact(ContactType::k2D, 0.5), {2, 3}).at(0).kind, ViolationKind::kSlips);
  EXPECT_TRUE(judged(one_contact(ContactType::k2D, 0.7), {2, 3}).empty());
  Scene without = point;
  without.contacts[0].mu.reset();
  EXPECT_TRUE(judged(without, {6, 8, -10}).empty());
}

// A foot is tilted by 40 degrees on flat ground: its pressure is relative to the ground, in any axes.
TEST(Violations, TheGroundIsTheNormal) {
  const auto of_tilted = [](ContactType type, ReferenceFrame frame, const Vec3<double>& in_world,
                            std::optional<Vec3<double>> normal) {
    Scene scene = one_contact(type, 0.5);
    scene.contacts[0].reference_frame = frame;
    scene.contacts[0].normal = normal;
    const Mat3<double> R = rotation_about<double>(Vec3<double>::UnitY(), 0.7);
    const Eigen::VectorXd q = pose_of_placement(SE3<double>{R, {0, 0, 1}});
    Eigen::VectorXd f = frame == ReferenceFrame::kLocal ? Vec3<double>(R.transpose() * in_world) : in_world;
    if (type == ContactType::k2D) f = Eigen::Vector2d(f[0], f[2]);
    if (type == ContactType::k6D) f.conservativeResizeLike(Eigen::VectorXd::Zero(6));
    std::string out;
    for (const Violation& v : violations(scene, q, f, {0})) out += to_string(v.kind);
    return out;
  };
  const Vec3<double> up(0, 0, 10), along_foot(10 * std::sin(0.7), 0, 10 * std::cos(0.7)), wall(1, 0, 0);
  for (ReferenceFrame frame : {ReferenceFrame::kLocal, ReferenceFrame::kWorld}) {
    for (ContactType type : {ContactType::k2D, ContactType::k3D}) {
      EXPECT_EQ(of_tilted(type, frame, up, {}), "");
      EXPECT_EQ(of_tilted(type, frame, along_foot, {}), "slips");
      EXPECT_EQ(of_tilted(type, frame, -up, {}), "pulls");
      EXPECT_EQ(of_tilted(type, frame, up, wall), "slips");
      EXPECT_EQ(of_tilted(type, frame, 10 * wall, wall), "");
      EXPECT_EQ(of_tilted(type, frame, 10 * wall, Vec3<double>(-wall)), "pulls");
    }
    EXPECT_EQ(of_tilted(ContactType::k6D, frame, along_foot, {}), "");  // a sole lies on its ground
    EXPECT_EQ(of_tilted(ContactType::k6D, frame, up, {}), "slips");
    EXPECT_EQ(of_tilted(ContactType::k6D, frame, up, Vec3<double>(0, 0, 2)), "");
  }
}

// With `to` the normal is in B' axes, on a body that moves and on one that cannot.
TEST(Violations, TheNormalOfAnotherBody) {
  for (const std::string base : {"floating", "fixed"}) {
    const SceneFile file = load_text(
        "<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/><robot name=\"wall\" urdf=\"box.urdf\" base=\"" +
        base + "\" xyz=\"2 0 0\" rpy=\"0 0.5 0\"/>" +
        "<contact name=\"c\" type=\"3d\" frame=\"b/crate\" to=\"wall/crate\" mu=\"0.1\" normal=\"-3 0 0\" "
        "to_offset_quat_xyzw=\"0 0 0 1\"/></scene>");
    const Vec3<double> n = rotation_about<double>(Vec3<double>::UnitY(), 0.5) * -Vec3<double>::UnitX();
    EXPECT_TRUE(violations(file.scene, file.q, Eigen::VectorXd(n), {0}).empty());
    EXPECT_EQ(violations(file.scene, file.q, Eigen::VectorXd(-n), {0}).at(0).kind, ViolationKind::kPulls);
    EXPECT_EQ(violations(file.scene, file.q, Eigen::VectorXd(Vec3<double>::UnitY()), {0}).at(0).kind,
              ViolationKind::kSlips);
  }
}

// Copies in a circle rotate the normals of walls with them; normals of the ground need no rotation.
TEST(Violations, NormalsOfCopiesAreTurned) {
  const SceneFile file = load_text(
      "<scene><robot name=\"h\" urdf=\"box.urdf\" base=\"floating\" copies=\"4\" arrange=\"circle\" spacing=\"2\"/>"
      "<contact name=\"c\" type=\"3d\" frame=\"h/crate\" mu=\"0.5\" normal=\"1 0 1\"/></scene>");
  for (std::size_t k = 0; k < 4; ++k) {
    const Mat3<double> R = file.scene.robots[k].base.R * file.scene.robots[0].base.R.transpose();
    EXPECT_LE((*file.scene.contacts[k].normal - R * Vec3<double>(1, 0, 1).normalized()).norm(), 1e-15);
  }
  EXPECT_GT((*file.scene.contacts[1].normal - *file.scene.contacts[0].normal).norm(), 0.5);
}

TEST(Violations, TipAndTurn) {
  const Scene sole = one_contact(ContactType::k6D, 0.5, {0.2, 0.1});
  EXPECT_TRUE(judged(sole, {0, 0, 100, 4.9, 9.9, 0}).empty());
  auto found = judged(sole, {0, 0, 100, 0, -13, 0});  // centre of pressure 0.13 m ahead
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, ViolationKind::kTips);
  EXPECT_NEAR(found[0].by, 0.03, 1e-12);
  EXPECT_NEAR(judged(sole, {0, 0, 100, 6, 0, 0}).at(0).by, 0.01, 1e-12);
  // no other force: torque up to mu n (X + Y) = 0.5 * 100 * 0.15
  EXPECT_TRUE(judged(sole, {0, 0, 100, 0, 0, 7.4}).empty());
  found = judged(sole, {0, 0, 100, 0, 0, -8});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, ViolationKind::kTurns);
  EXPECT_NEAR(found[0].by, 0.5, 1e-12);
}

// No sum of forces within their cones at the corners is a violation.
TEST(Violations, NoneOfForcesAtTheCorners) {
  const double mu = 0.6, X = 0.1, Y = 0.05;
  const Scene sole = one_contact(ContactType::k6D, mu, {2 * X, 2 * Y});
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int k = 0; k < 2000; ++k) {
    Vec6<double> sum = Vec6<double>::Zero();
    for (const double x : {-X, X})
      for (const double y : {-Y, Y}) {
        const double n = unit(rng), t = mu * n * std::sqrt(unit(rng)), angle = 2 * M_PI * unit(rng);
        const Vec3<double> f(t * std::cos(angle), t * std::sin(angle), n), r(x, y, 0);
        sum.head<3>() += f;
        sum.tail<3>() += r.cross(f);
      }
    const Eigen::VectorXd f = sum;
    EXPECT_TRUE(violations(sole, neutral(*sole.robots[0].model), f, {0}).empty()) << f.transpose();
  }
}

// In free fall contact forces are zero but for rounding errors of the weights.
TEST(Violations, NoneOfRoundingErrors) {
  const SceneFile file = load_text(
      "<scene><robot name=\"low\" urdf=\"box.urdf\" base=\"floating\"/>"
      "<robot name=\"high\" urdf=\"box.urdf\" base=\"floating\" xyz=\"0 0 1\"/>"
      "<contact name=\"on\" type=\"3d\" frame=\"high/crate\" to=\"low/crate\" mu=\"0.5\"/></scene>");
  Eigen::VectorXd f(3);
  for (const double size : {1e-10, 1e-3}) {
    f << size, 0, -size;
    EXPECT_EQ(violations(file.scene, file.q, f, {0}).size(), size < 1e-9 ? 0u : 1u) << size;
  }
  const Eigen::VectorXd loads = Eigen::VectorXd::Constant(2, 1e7);
  EXPECT_TRUE(violations(file.scene, file.q, f, {0}, loads).empty());
}

// A point slides on a plane while its body turns. The rows of local axes turn with it, those of the world do not.
TEST(TurningRows, OfPointsThatSlide) {
  const auto scene = [](const std::string& contact, const std::string& v) {
    return load_text("<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"><joint name=\"root\" v=\"" + v +
                     "\"/></robot><contact name=\"slides\" frame=\"b/crate\" " + contact + "/></scene>");
  };
  const auto rate_of = [&](const std::string& contact, const std::string& v) {
    const SceneFile file = scene(contact, v);
    const auto found = turning_rows(file.scene, file.q, file.v, {1});
    return found.empty() ? 0 : found[0].rate;
  };
  EXPECT_DOUBLE_EQ(rate_of("type=\"1d\"", "3 0 0 0 2 0"), 6);
  EXPECT_DOUBLE_EQ(rate_of("type=\"2d\"", "0 3 0 0 0 2"), 6);
  EXPECT_EQ(rate_of("type=\"1d\" reference_frame=\"world\"", "3 0 0 0 2 0"), 0);
  EXPECT_EQ(rate_of("type=\"1d\"", "3 0 0 0 0 2"), 0);  // about the axis
  EXPECT_EQ(rate_of("type=\"1d\"", "0 0 3 0 2 0"), 0);  // along it: the contact is not satisfied
  EXPECT_EQ(rate_of("type=\"3d\"", "3 0 0 0 2 0"), 0);
}

TEST(Limits, PositionVelocityEffort) {
  const auto passed = [](const std::string& inside) {
    const SceneFile file =
        load_text("<scene><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\">" + inside + "</robot></scene>");
    return limits_passed(file.scene, file.q, file.v, file.u);
  };
  EXPECT_TRUE(passed("").empty());
  const SceneFile file = load_text("<scene><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"/></scene>");
  const Joint& joint = file.scene.robots[0].model->joints[1];
  const auto quoted = [](double x) { return "=\"" + std::to_string(x) + "\""; };
  const std::string begin = "<joint name=\"" + joint.name + "\" ";
  auto found = passed(begin + "q" + quoted(joint.upper[0] + 0.25) + "/>");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].quantity, LimitKind::kPosition);
  EXPECT_EQ(found[0].dof, joint.idx_v);
  EXPECT_NEAR(found[0].value - found[0].limit, 0.25, 1e-5);
  found = passed(begin + "q" + quoted(joint.lower[0] - 0.25) + "/>");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].limit, joint.lower[0]);
  found = passed(begin + "v" + quoted(-2 * joint.velocity_limit[0]) + " u" + quoted(3 * joint.effort_limit[0]) + "/>");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].quantity, LimitKind::kVelocity);
  EXPECT_EQ(found[1].quantity, LimitKind::kEffort);
  EXPECT_EQ(found[1].limit, joint.effort_limit[0]);
}

// Rounding error does not exceed a limit of 0: the excess is relative to the range.
TEST(Limits, OfZeroAreNotPassedByRounding) {
  SceneFile file = load_text("<scene><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"/></scene>");
  auto model = std::make_shared<Model>(*file.scene.robots[0].model);
  Joint& joint = model->joints[1];
  joint.lower[0] = 0, joint.upper[0] = 2;
  file.scene.robots[0].model = model;
  const auto passed = [&](double q) {
    file.q[joint.idx_q] = q;
    return limits_passed(file.scene, file.q, file.v, file.u).size();
  };
  EXPECT_EQ(passed(-1e-19), 0u);
  EXPECT_EQ(passed(-1e-12), 0u);
  EXPECT_EQ(passed(-1e-6), 1u);
  EXPECT_EQ(passed(2 + 1e-12), 0u);
  EXPECT_EQ(passed(2 + 1e-6), 1u);
}

// Equal limits are limits, 0 as well; crossed ones and a velocity limit of 0 are none.
TEST(Limits, EqualOnesArePassed) {
  SceneFile file = load_text("<scene><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"/></scene>");
  const auto passed = [&](double lower, double upper, double q) {
    auto model = std::make_shared<Model>(*file.scene.robots[0].model);
    model->joints[1].lower[0] = lower, model->joints[1].upper[0] = upper, model->joints[1].velocity_limit[0] = 0;
    file.scene.robots[0].model = model;
    file.q[model->joints[1].idx_q] = q;
    return limits_passed(file.scene, file.q, file.v, file.u);
  };
  for (const double limit : {0.0, 0.3, -0.3}) {
    EXPECT_TRUE(passed(limit, limit, limit).empty());
    EXPECT_TRUE(passed(limit, limit, limit * (1 + 1e-12)).empty());
    for (const double off : {0.1, -0.1}) {
      const auto found = passed(limit, limit, limit + off);
      ASSERT_EQ(found.size(), 1u) << limit << " " << off;
      EXPECT_EQ(found[0].limit, limit);
      EXPECT_EQ(found[0].quantity, LimitKind::kPosition);
    }
  }
  EXPECT_TRUE(passed(0.4, -0.4, 0.1).empty());
}

TEST(Contradictions, TellTheirSize) {
  // at one point of the world the gains of two contacts request different changes of velocity
  SceneFile file = load_text(
      "<scene>" + std::string("<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"><v>0 0 1 0 0 0</v></robot>") +
      "<contact name=\"first\" type=\"3d\" frame=\"b/crate\"/>"
      "<contact name=\"second\" type=\"3d\" frame=\"b/crate\" gains=\"0 10\"/></scene>");
  SceneData data(file.scene);
  (void)solve(file.scene, file.q, file.v, file.u, data);
  ASSERT_EQ(data.report.status, Status::kInconsistent);
  const auto found = contradictions(file.scene, data);
  ASSERT_EQ(found.size(), 2u);  // the rows request 0 and -10 m/s^2: the least squares miss both by 5
  for (const Contradiction& c : found) EXPECT_NEAR(c.linear, 5, 1e-9);
  file.scene.contacts[1].beta = 0;
  (void)solve(file.scene, file.q, file.v, file.u, data);
  EXPECT_TRUE(contradictions(file.scene, data).empty());
}

TEST(MasslessJoint, JointsByName) {
  const TemporaryFolder folder;
  (void)folder.write("r.urdf", R"(<robot name="r">
    <link name="base"/>
    <link name="arm"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <link name="ghost"/>
    <joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint>
    <joint name="wrist" type="continuous"><parent link="arm"/><child link="ghost"/><axis xyz="0 1 0"/></joint></robot>)");
  const SceneFile file =
      load_scene(folder.write("scene.xml", "<scene><robot name=\"r\" urdf=\"r.urdf\" base=\"fixed\"/></scene>"));
  SceneData data(file.scene);
  (void)solve(file.scene, file.q, file.v, file.u, data);
  ASSERT_EQ(data.report.status, Status::kFailed);
  const std::vector<MasslessJoint> found = massless_joints(file.scene, data, file.q);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].joint + ": " + found[0].why, "r/wrist: there is no mass below the joint");
  const SceneFile sound = held("");
  EXPECT_TRUE(massless_coordinates(sound.scene.robots[0], sound.q).empty());
}

}  // namespace
}  // namespace manycontact::test
