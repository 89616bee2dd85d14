// Velocities that violate a contact, and states made consistent, are compared with dense projections.

#include "manycontact/analysis/consistent.hpp"

#include <cmath>
#include <filesystem>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "support/dense.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"
#include "support/terms.hpp"

namespace manycontact::test {
namespace {

const std::string kMechanisms = MANYCONTACT_SHARED_DIR "/mechanisms/";

std::vector<char> active_of(const Scene& scene) {
  std::vector<char> active;
  for (const Contact& contact : scene.contacts) active.push_back(contact.active);
  return active;
}
std::vector<VelocityError> moving(const SceneFile& file) {
  return velocity_errors(file.scene, file.q, file.v, active_of(file.scene));
}

// A four-bar in its plane is closed by its pin with the first crank at q1 = 0.3.
class FourBar {
 public:
  explicit FourBar(const std::string& scene_attributes = "", const std::string& pin = "", double q2 = -0.4) {
    (void)folder_.write("fourbar.urdf", R"(<robot name="fourbar"><link name="base"/>
      <link name="crank"><inertial><origin xyz="0 0 0.25"/><mass value="1"/>
        <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.001"/></inertial></link>
      <link name="coupler"><inertial><origin xyz="0.4 0 0"/><mass value="1"/>
        <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.05"/></inertial></link>
      <link name="rocker"><inertial><origin xyz="0 0 -0.3"/><mass value="1"/>
        <inertia ixx="0.03" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.001"/></inertial></link>
      <joint name="j1" type="continuous"><parent link="base"/><child link="crank"/><axis xyz="0 1 0"/></joint>
      <joint name="j2" type="continuous"><origin xyz="0 0 0.5"/><parent link="crank"/><child link="coupler"/>
        <axis xyz="0 1 0"/></joint>
      <joint name="j3" type="continuous"><origin xyz="0.8 0 0"/><parent link="coupler"/><child link="rocker"/>
        <axis xyz="0 1 0"/></joint></robot>)");
    path_ = folder_.write(
        "scene.xml",
        "<scene " + scene_attributes +
            R"(><robot name="r" urdf="fourbar.urdf"><joint name="j1" q="0.3" v="1"/><joint name="j2" q=")" +
            std::to_string(q2) + R"("/><joint name="j3" q="0.25"/></robot>
        <contact name="pin" type="2d" frame="r/rocker" offset="0 0 -0.6" reference_frame="world" )" +
            pin + "/></scene>");
  }
  SceneFile load() const { return load_scene(path_); }
  const std::string& path() const { return path_; }

 private:
  TemporaryFolder folder_;
  std::string path_;
};

const std::string kAway = R"(xyz="0.9 0 -0.05")";

// ---- what is reported ---------------------------------------------------------------------------------------------

TEST(VelocityErrors, OfEveryType) {
  const auto error = [](const std::string& type, const std::string& v, const std::string& more) {
    const SceneFile file =
        load_text("<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"><v>" + v +
                  "</v></robot><contact name=\"c\" type=\"" + type + "\" frame=\"b/crate\" " + more + "/></scene>");
    const auto found = moving(file);
    return found.empty() ? VelocityError{-1} : found[0];
  };
  EXPECT_NEAR(error("3d", "3 4 0 0 0 0", "").linear, 5, 1e-12);
  EXPECT_EQ(error("3d", "3 4 0 0 0 0", "").angular, 0);
  EXPECT_NEAR(error("3d", "0 0 0 0 0 2", "offset=\"0.5 0 0\"").linear, 1, 1e-12);
  EXPECT_NEAR(error("1d", "3 4 0 0 0 0", "axis=\"0 1 0\"").linear, 4, 1e-12);
  EXPECT_EQ(error("1d", "3 0 0 1 1 1", "axis=\"0 1 0\"").contact, -1);
  EXPECT_NEAR(error("2d", "3 9 4 0 0 0", "").linear, 5, 1e-12);  // y is free
  EXPECT_NEAR(error("6d", "0 0 0 0 0.8 0", "").angular, 0.8, 1e-12);
  EXPECT_LT(error("6d", "0 0 0 0 0.8 0", "").linear, 1e-12);
  EXPECT_NEAR(error("5d", "0 0 0 3 4 7", "axis=\"0 0 1\"").angular, 5, 1e-12);
  EXPECT_EQ(error("5d", "0 0 0 0 0 7", "axis=\"0 0 1\"").contact, -1);  // about the hinge
  EXPECT_EQ(error("6d", "0 0 5e-7 0 0 0", "").contact, -1);             // files round as much
  EXPECT_EQ(error("6d", "0 0 5 0 0 0", "active=\"false\"").contact, -1);
}

// The velocity of a contact between two robots is the relative one.
TEST(VelocityErrors, BetweenRobots) {
  const SceneFile file = load_text(
      "<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\" copies=\"3\"><v>1 0 0 0 0 0</v></robot>"
      "<robot name=\"d\" urdf=\"box.urdf\" base=\"floating\" xyz=\"9 0 0\"><v>0 2 0 0 0 0</v></robot>"
      "<contact name=\"c\" type=\"3d\" frame=\"b/crate\" to=\"b+1/crate\"/>"
      "<contact name=\"e\" type=\"3d\" frame=\"b2/crate\" to=\"d/crate\"/></scene>");
  const auto found = moving(file);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(file.scene.contacts[found[0].contact].name, "e");
  EXPECT_NEAR(found[0].linear, std::sqrt(5), 1e-12);
}

// ---- velocities ---------------------------------------------------------------------------------------------------

// v+ = v - M^-1 J^T (J M^-1 J^T)^-1 J v is computed from dense products.
TEST(MakeConsistent, ProjectsVelocities) {
  for (const char* name : {"humanoid_standing.xml", "two_humanoids_carry_beam.xml", "quadruped_loop.xml"}) {
    SceneFile file = load_small(kModels + name);
    std::mt19937 rng(3);
    disturb(file, rng, 0);
    ASSERT_FALSE(moving(file).empty());
    const ConsistentState state = make_consistent(file.scene, file.q, file.v);
    EXPECT_TRUE(state.consistent()) << name;
    EXPECT_LT(difference(file.scene, file.q, state.q).cwiseAbs().maxCoeff(), 1e-12) << name;  // it was in place already
    const Terms t(file.scene, active_of(file.scene), state.q, file.v, file.u);
    const Eigen::MatrixXd Minv_Jt = solved(t.M, t.J.transpose());
    const Eigen::VectorXd expected = file.v - Minv_Jt * least_norm(t.J * Minv_Jt, t.J * file.v);
    EXPECT_LT((state.v - expected).cwiseAbs().maxCoeff(), 1e-9 * file.v.cwiseAbs().maxCoeff()) << name;
    EXPECT_LT((t.J * state.v).cwiseAbs().maxCoeff(), 1e-11) << name;
  }
}

TEST(MakeConsistent, LeavesWhatFits) {
  SceneFile file = load_text(
      "<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"><v>0 0 0 0 0 3</v></robot>"
      "<contact name=\"c\" type=\"3d\" frame=\"b/crate\"/></scene>");
  const ConsistentState state = make_consistent(file.scene, file.q, file.v);
  EXPECT_EQ(state.q, file.q);
  EXPECT_EQ(state.v, file.v);
  EXPECT_EQ(state.steps, 0);
  EXPECT_TRUE(state.consistent());
  EXPECT_THROW((void)make_consistent(file.scene, file.q.head(3), file.v), std::invalid_argument);
}

// ---- positions ----------------------------------------------------------------------------------------------------

TEST(MakeConsistent, ClosesALoop) {
  const FourBar bar("", kAway);
  SceneFile file = bar.load();
  ASSERT_EQ(placement_errors(file.scene, file.q, {1}).size(), 1u);
  const ConsistentState state = make_consistent(file.scene, file.q, file.v);
  EXPECT_TRUE(state.consistent());
  EXPECT_GT(state.steps, 1);
  EXPECT_LT(state.steps, 10);
  const Terms t(file.scene, {1}, state.q, state.v, file.u);
  EXPECT_LT((t.J * state.v).norm(), 1e-13);
  file.scene.contacts[0].alpha = 1;
  const Eigen::VectorXd e = Terms(file.scene, {1}, state.q, Eigen::VectorXd::Zero(3), file.u).a0;
  EXPECT_LT(e.norm(), 1e-13);
}

// The first step is the smallest in the M-norm: M dq is in the range of J^T.
TEST(MakeConsistent, MovesTheLeast) {
  const double away = 1e-6;  // one step suffices, up to its square
  SceneFile file = load_text(
      "<scene><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"/>"
      "<contact name=\"c\" type=\"3d\" frame=\"a/tool\"/></scene>");
  std::mt19937 rng(5);
  disturb(file, rng, 0.5);
  resolve_references(file.scene, file.q);
  file.scene.contacts[0].B.placement.p += Vec3<double>(away, 2 * away, -away);
  const ConsistentState state = make_consistent(file.scene, file.q, file.v);
  EXPECT_TRUE(state.consistent());
  const Eigen::VectorXd dq = difference(file.scene, file.q, state.q);
  const Terms t(file.scene, {1}, file.q, file.v, file.u);
  const Eigen::VectorXd p = t.M * dq;
  const Eigen::VectorXd f = least_norm(t.J.transpose(), p);
  EXPECT_GT(p.norm(), 1e-9);
  EXPECT_LT((t.J.transpose() * f - p).norm(), 1e-4 * p.norm());
}

// Frames are rotated against each other by much, and two robots meet half way, the lighter one moving more.
TEST(MakeConsistent, TurnsAndMeets) {
  SceneFile file = load_text(
      "<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\" xyz=\"1 2 3\"/>"
      "<robot name=\"d\" urdf=\"box.urdf\" base=\"floating\" xyz=\"5 2 3\" rpy=\"0.4 -1 2\"/>"
      "<contact name=\"c\" type=\"6d\" frame=\"b/crate\" to=\"d/crate\" to_offset=\"0 0 0\" "
      "to_offset_quat_xyzw=\"0 0 0 1\"/></scene>");
  const ConsistentState state = make_consistent(file.scene, file.q, file.v);
  EXPECT_TRUE(state.consistent());
  EXPECT_NEAR(state.q[0], 3, 1e-9);  // equal masses
  EXPECT_NEAR(state.q[7], 3, 1e-9);
}

TEST(MakeConsistent, SaysWhatCannotBeClosed) {
  // two contacts request different points of the world
  SceneFile torn = load_text(
      "<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>"
      "<contact name=\"one\" type=\"3d\" frame=\"b/crate\" xyz=\"0 0 1\"/>"
      "<contact name=\"two\" type=\"3d\" frame=\"b/crate\" xyz=\"0 0 3\"/>"
      "<contact name=\"off\" type=\"3d\" frame=\"b/crate\" xyz=\"9 0 3\" active=\"false\"/></scene>");
  ConsistentState state = make_consistent(torn.scene, torn.q, torn.v);
  ASSERT_EQ(state.misplaced.size(), 2u);
  for (const PlacementError& e : state.misplaced) EXPECT_NEAR(e.position, 1, 1e-9);  // half way
  EXPECT_NEAR(state.q[2], 2, 1e-9);
  EXPECT_TRUE(state.moving.empty());

  // no crank reaches the pin: the least distance is what the bars lack
  SceneFile far = FourBar("", R"(xyz="3 0 0")").load();
  state = make_consistent(far.scene, far.q, far.v);
  ASSERT_EQ(state.misplaced.size(), 1u);
  EXPECT_NEAR(state.misplaced[0].position, 3 - 0.5 - 0.8 - 0.6, 1e-4);

  // without inertia there is no metric
  TemporaryFolder folder;
  (void)folder.write("ghost.urdf", R"(<robot name="g"><link name="w"/><link name="l"/><joint name="j" type="prismatic">
    <parent link="w"/><child link="l"/><limit effort="1" velocity="1" lower="-9" upper="9"/></joint></robot>)");
  const SceneFile ghost =
      load_scene(folder.write("s.xml",
                              "<scene><robot name=\"g\" urdf=\"ghost.urdf\"/>"
                              "<contact name=\"c\" type=\"1d\" axis=\"0 1 0\" frame=\"g/l\" xyz=\"0 1 0\"/></scene>"));
  state = make_consistent(ghost.scene, ghost.q, ghost.v);
  EXPECT_EQ(state.status, Status::kFailed);
  EXPECT_EQ(state.misplaced.size(), 1u);
}

// Bricard's mechanism, torn open, has more rows than the loop needs.
TEST(MakeConsistent, ClosesBricard) {
  const std::string path = kMechanisms + "03-bricard/scene_5d.xml";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "skipped: " << path << " is not there";
  SceneFile file = load_scene(path);
  for (double size : {1e-3, 1e-1}) {
    const Eigen::VectorXd w = size * Eigen::VectorXd::LinSpaced(file.scene.nv, -1, 0.7);
    const ConsistentState state = make_consistent(file.scene, integrate(file.scene, file.q, w), file.v);
    EXPECT_TRUE(state.consistent()) << size << " " << state.steps;
  }
}

TEST(MakeConsistent, OfMechanismsReported) {
  if (!std::filesystem::exists(kMechanisms + "12-assembly")) GTEST_SKIP() << "skipped: no " << kMechanisms;
  SceneFile pin = load_scene(kMechanisms + "12-assembly/scene_velocity.xml");
  ASSERT_EQ(moving(pin).size(), 1u);
  EXPECT_NEAR(moving(pin)[0].linear, 0.85, 0.01);
  EXPECT_TRUE(make_consistent(pin.scene, pin.q, pin.v).consistent());
  SceneFile foot = load_scene(kMechanisms + "12-assembly/foot.xml");
  ASSERT_EQ(moving(foot).size(), 1u);
  EXPECT_NEAR(moving(foot)[0].linear, 1, 1e-12);
  EXPECT_EQ(make_consistent(foot.scene, foot.q, foot.v).v.norm(), 0);
}

// ---- scenes with consistent="true" --------------------------------------------------------------------------------

TEST(ConsistentScenes, AreMadeSoWhenLoaded) {
  const FourBar plain("", kAway), bar("consistent=\"true\"", kAway), no("consistent=\"false\"", kAway);
  EXPECT_TRUE(plain.load().findings.empty());
  EXPECT_EQ(no.load().q, plain.load().q);
  const SceneFile file = bar.load();
  EXPECT_TRUE(placement_errors(file.scene, file.q, {1}).empty());
  EXPECT_TRUE(moving(file).empty());
  ASSERT_EQ(file.findings.size(), 1u);
  EXPECT_EQ(file.findings[0].kind, "consistent");
  EXPECT_EQ(file.findings[0].file, bar.path());
  EXPECT_NE(file.findings[0].text.find("q changed most at r/j"), std::string::npos) << file.findings[0].text;
  EXPECT_EQ(read_scene(bar.path()).q, plain.load().q);  // reading solves nothing
  const FourBar fits("consistent=\"true\"");            // in place, but not its velocity
  EXPECT_LT((fits.load().q - plain.load().q).norm(), 1e-15);
  EXPECT_EQ(fits.load().findings.at(0).text.find("q changed most"), std::string::npos);
}

TEST(ConsistentScenes, AreRefusedWhereTheyCannotBe) {
  const FourBar bar("\n consistent=\"true\"", R"(xyz="3 0 0")");
  try {
    (void)bar.load();
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.line, 2);
    EXPECT_NE(e.message.find("contact 'pin' stays out of place by 1.1 m"), std::string::npos) << e.message;
  }
}

}  // namespace
}  // namespace manycontact::test
