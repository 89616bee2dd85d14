// Tests each kind of fault that attacks found, with inputs made here, and with the inputs found where these exist.

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/analysis/errors.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/simulation/switch.hpp"
#include "support/folder.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/terms.hpp"
#include "support/truth.hpp"

namespace manycontact::test {
namespace {

std::vector<Method> methods_for_dependent_rows() {
  std::vector<Method> list;
  for (Method m : methods())
    if (m != Method::kDenseSchur) list.push_back(m);
  return list;
}

struct Solved {
  SceneFile file;
  SceneData data;
  Solved(SceneFile f, Method method) : file(std::move(f)), data(file.scene, {method, {}}) {
    (void)solve(file.scene, file.q, file.v, file.u, data);
  }
  const Report& report() const { return data.report; }
};

// Expects errors relative to the truth in quadruple precision below their stated bounds.
void expect_true_bounds(Solved s, const std::string& what) {
  estimate_errors(s.file.scene, s.data);
  const auto truth = solve_truth<Quad>(s.file.scene, s.data.active, s.file.q.cast<Quad>(), s.file.v.cast<Quad>(),
                                       s.file.u.cast<Quad>());
  const auto expect_below = [&](const Eigen::VectorXd& x, const VecX<Quad>& right, double bound, const char* name) {
    const double error = largest_entry(x.cast<Quad>() - right);
    EXPECT_LE(error, bound * largest_entry(x)) << what << " " << to_string(s.report().islands[0].method) << " " << name;
  };
  ASSERT_EQ(s.report().islands.size(), 1u);
  ASSERT_TRUE(truth.regular[0]);
  ASSERT_EQ(truth.rank[0], s.report().rank);
  expect_below(s.data.a, truth.a, s.report().islands[0].error_acceleration, "accelerations");
  expect_below(s.data.f, truth.f, s.report().islands[0].error_forces, "forces");
}

// Reads ../shared/attack/faults, where they exist.
class Reported : public testing::Test {
 protected:
  SceneFile load(const std::string& name) const {
    return load_scene(std::string(MANYCONTACT_SHARED_DIR) + "/attack/faults/" + name + "/scene.xml");
  }
  void SetUp() override {
    if (!std::filesystem::exists(std::string(MANYCONTACT_SHARED_DIR) + "/attack/faults")) GTEST_SKIP();
  }
  void expect_forces(const std::string& name, int rank, const std::vector<double>& f) const {
    for (Method method : methods_for_dependent_rows()) {
      SCOPED_TRACE(to_string(method));
      const Solved s(load(name), method);
      EXPECT_EQ(s.report().status, Status::kRedundant);
      EXPECT_EQ(s.report().rank, rank);
      for (std::size_t k = 0; k < f.size(); ++k) EXPECT_NEAR(s.data.f[k], f[k], 1e-10 * std::abs(f[k]));
    }
  }
};

TEST_F(Reported, TwoJointsHoldTwoRows) {
  expect_forces("01-spurious-rank-arm-2-joints", 2, {8.875890210111, 1.621498668751, 1.867407129701});
}
TEST_F(Reported, TwoPointsHoldFiveRows) {
  expect_forces("02-spurious-rank-box-2-points", 5,
                {1.332198509811, -4.866052204993, 1.132697617452, -3.761427739041, -6.342942324290, -16.684128741732});
}
TEST_F(Reported, FourFeetHoldNoMoreThanThereIs) {
  for (Method method : methods_for_dependent_rows()) {
    SCOPED_TRACE(to_string(method));
    const Solved s(load("03b-spurious-rank-anymal-four-feet"), method);
    EXPECT_EQ(s.report().rank, 18);
    EXPECT_NEAR(contact_force(s.file.scene, s.data, "lh_foot")[1], 115.67, 0.005);
  }
}
TEST_F(Reported, SingularInertiaFails) {
  for (Method method : methods()) {
    SCOPED_TRACE(to_string(method));
    EXPECT_EQ(Solved(load("04-singular-inertia-ok"), method).report().status, Status::kFailed);
  }
}
TEST_F(Reported, ALightLinksForcesChangeRightly) {
  for (Method method : methods_for_dependent_rows()) {
    SCOPED_TRACE(to_string(method));
    Solved s(load("05-dforces-dq-light-link"), method);
    (void)differentiate(s.file.scene, s.data);
    EXPECT_NEAR(dense_derivatives(s.file.scene, s.data).dforces_dq(2, 2), -5.8100865282252, 1e-10);
  }
}
TEST_F(Reported, ASmallContradictionCounts) {
  for (Method method : methods_for_dependent_rows()) {
    SCOPED_TRACE(to_string(method));
    Solved s(load("07-contradiction-dropped-spinning"), method);
    (void)differentiate(s.file.scene, s.data);
    EXPECT_NEAR(dense_derivatives(s.file.scene, s.data).da_dq(1, 2), 0.002571686386, 1e-9);
  }
}
TEST_F(Reported, RoundingIsNoContradictionWithoutGravity) {
  for (Method method : methods_for_dependent_rows()) {
    const Solved s(load("09-false-inconsistent-weightless"), method);
    EXPECT_EQ(s.report().status, Status::kRedundant) << to_string(method);
    EXPECT_EQ(s.report().rank, 2) << to_string(method);
  }
}
TEST_F(Reported, BoundsHoldGainsAndProjectionsIncluded) {
  for (const char* name : {"10b-bodies-bound-5-links", "11-projector-bound", "05-dforces-dq-light-link"})
    for (Method method : methods_for_dependent_rows()) expect_true_bounds(Solved(load(name), method), name);
}
TEST_F(Reported, DampedDerivativesAreNumbers) {
  for (Method method : methods_for_dependent_rows()) {
    SCOPED_TRACE(to_string(method));
    Solved s(load("13-nan-derivatives-supernodal"), method);
    (void)differentiate(s.file.scene, s.data);
    EXPECT_TRUE(dense_derivatives(s.file.scene, s.data).da_dq.allFinite());
  }
}
TEST_F(Reported, SpringsOfOtherRobotsAreNotForgotten) {
  for (Method method : methods()) {
    SCOPED_TRACE(to_string(method));
    Solved s(load("22-lanes-forget-springs"), method);
    (void)differentiate(s.file.scene, s.data);
    const SceneDerivatives d = dense_derivatives(s.file.scene, s.data);
    Eigen::Matrix2d by_q, by_v;
    by_q << 1.376966426586, -5.450935366433, -30.483224277038, 19.362986878725;
    by_v << 1.406643751779, 0.313735525143, -8.650834715754, -0.969480461125;
    EXPECT_LE((d.da_dq.block<2, 2>(6, 6) - by_q).norm(), 1e-9);
    EXPECT_LE((d.da_dv.block<2, 2>(6, 6) - by_v).norm(), 1e-9);
    for (const DerivativeBounds& bound : estimate_derivative_errors(s.file.scene, s.data))
      EXPECT_LE(bound.da_dq, 1e-8);  // cond(K) is 100 to 1,000
  }
}
TEST_F(Reported, TheConditionOfASmallKIsExact) {
  for (Method method : methods()) {
    SCOPED_TRACE(to_string(method));
    Solved s(load("14-condition-38-times-too-low"), method);
    estimate_condition(s.file.scene, s.data);
    EXPECT_NEAR(s.report().condition, 10300022, 1e-3 * 10300022);
  }
}

// ---- kinds ----------------------------------------------------------------------------------------------------

SceneFile box(const std::string& contacts, const std::string& attributes = "") {
  return load_text("<scene name=\"s\" " + attributes + "><robot name=\"r\" urdf=\"box.urdf\" base=\"floating\"/>" +
                   contacts + "</scene>");
}

// Arms with more contact rows than joints, at rest and where contacts close, with gravity and without: rounding errors
// of rows must count neither as independent rows nor as inconsistency.
class HeldArms : public testing::TestWithParam<std::string> {
 protected:
  SceneFile load(const std::string& gravity) const {
    std::string contacts;
    for (const char* frame : {"tool", "link_5", "link_3"})
      contacts += "<contact name=\"" + std::string(frame) + "\" type=\"" + GetParam() + "\" frame=\"a/" + frame +
                  "\" offset=\"0.05 -0.02 0.1\"/>";
    return load_text("<scene gravity=\"" + gravity + "\"><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"/>" +
                     contacts + "</scene>");
  }
};

TEST_P(HeldArms, AtRestAreRedundant) {
  std::mt19937 rng(38);
  for (const char* gravity : {"0 0 -9.81", "0 0 0"}) {
    SceneFile file = load(gravity);
    for (int k = 0; k < 10; ++k) {
      file.q = random_configuration(file.scene, rng);
      file.u = Eigen::VectorXd::Random(file.scene.nu);
      for (Contact& c : file.scene.contacts) resolve_reference(file.scene, file.q, true, true, c);
      for (Method method : methods_for_dependent_rows()) {
        const Solved s(file, method);
        EXPECT_EQ(s.report().status, Status::kRedundant) << gravity << " " << to_string(method);
        EXPECT_LE(s.report().rank, file.scene.nv) << to_string(method);
        const Terms t(file.scene, s.data.active, file.q, file.v, file.u);
        EXPECT_LT(t.dynamics_error(s.data.a, s.data.f), 1e-10) << to_string(method);
        EXPECT_LT(t.least_norm_error(s.data.f), 1e-9) << to_string(method);
      }
    }
  }
}

TEST_P(HeldArms, ImpactsDoNotContradictThemselves) {
  std::mt19937 rng(39);
  SceneFile file = load("0 0 -9.81");
  for (int k = 0; k < 20; ++k) {
    SimulationData sim(file.scene, random_configuration(file.scene, rng), Eigen::VectorXd::Random(file.scene.nv),
                       Integrator::kRk4, 1e-3);
    for (Contact& c : file.scene.contacts) resolve_reference(file.scene, sim.q, true, true, c);
    sim.dynamics.active.assign(3, 0);
    const VelocityJump jump = switch_contacts(file.scene, {1, 1, 1}, sim);
    EXPECT_EQ(jump.status, Status::kRedundant) << k;
    EXPECT_TRUE(velocity_errors(file.scene, sim.q, sim.v, {1, 1, 1}).empty()) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Types, HeldArms, testing::Values("3d", "5d", "6d"));

// Bounds include the effect of gains, for links at any depth, with the bodies' system too.
TEST(Bounds, CountGains) {
  std::mt19937 rng(40);
  SceneFile file = load_text(
      "<scene><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"/>"
      "<contact name=\"c\" type=\"6d\" frame=\"a/tool\" gains=\"2500 100\"/>"
      "<contact name=\"d\" type=\"3d\" frame=\"a/link_4\" gains=\"1e4 10\"/></scene>");
  for (int k = 0; k < 5; ++k) {
    disturb(file, rng, 0.3);
    for (Method method : methods_for_dependent_rows()) expect_true_bounds(Solved(file, method), "gains");
  }
}

// Writes a URDF of identical links l0, l1, ... on continuous joints.
class LinksFile {
 public:
  LinksFile(double mass, double inertia) {
    std::ostringstream of_link;
    of_link << "<inertial><mass value=\"" << mass << "\"/><inertia ixx=\"" << inertia << "\" iyy=\"" << inertia
            << "\" izz=\"" << inertia << "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>";
    inertial_ = of_link.str();
    text_ = "<robot name=\"r\"><link name=\"l0\">" + inertial_;
  }
  void add(int parent, const std::string& origin, const std::string& axis) {
    const std::string name = "l" + std::to_string(++last_);
    text_ += "<link name=\"" + name + "\">" + inertial_ + "<joint name=\"j" + name +
             "\" type=\"continuous\"><parent link=\"l" + std::to_string(parent) + "\"/><child link=\"" + name +
             "\"/><origin " + origin + "/><axis xyz=\"" + axis + "\"/></joint>";
  }
  std::string text() const { return text_ + "</robot>"; }

 private:
  std::string inertial_, text_;
  int last_ = 0;
};

// Least-norm forces on a point that joints move by a tenth of a millimetre, next to angular rows: their residual in the
// point's columns after orthogonal elimination is not in the null space.
TEST(Bounds, CountShortLeversBesideTurns) {
  const TemporaryFolder folder;
  LinksFile links(0.001, 1e-10);
  links.add(0, "", "1 0 0");
  links.add(1, "rpy=\"-0.88 0.3 -1.72\"", "0 1 0");
  links.add(0, "", "0.834 0.0803 0.483");
  links.add(3, "xyz=\"3.3e-4 2.6e-4 8e-6\"", "0 1 0");
  (void)folder.write("r.urdf", links.text());
  const SceneFile file = load_scene(folder.write(
      "scene.xml",
      "<scene gravity=\"0 0 0\"><robot name=\"r\" urdf=\"r.urdf\" base=\"fixed\"><u>1e-9 1e-9 1e-9 1e-9</u></robot>"
      "<contact name=\"near\" type=\"3d\" frame=\"r/l2\" offset=\"-8.5e-5 -1.14e-4 -1.22e-4\"/>"
      "<contact name=\"turned\" type=\"6d\" frame=\"r/l4\" offset=\"1.45e-4 1.57e-4 2.21e-4\"/></scene>"));
  for (Method method : methods_for_dependent_rows()) expect_true_bounds(Solved(file, method), "short lever");
}

// Returns the state `step` away, with the contacts' references set there.
SceneFile moved(const SceneFile& file, const Eigen::VectorXd& step) {
  SceneFile out = file;
  out.q = integrate(file.scene, file.q, step);
  resolve_references(out.scene, out.q);
  return out;
}

// A row along joints that hang from a fixed body moves only by rounding errors of its moment's terms.
TEST(Rank, OfRowsAlongJointsIsNoneOfRounding) {
  const TemporaryFolder folder;
  LinksFile links(1, 0.1);
  links.add(0, "xyz=\"0.3 0 0\"", "1 0 0");
  links.add(1, "xyz=\"0.04 -0.7 0.45\"", "1 0 0");
  links.add(2, "xyz=\"0.3 0 0\"", "0 1 0");
  (void)folder.write("r.urdf", links.text());
  const SceneFile file = load_scene(folder.write(
      "scene.xml",
      "<scene><robot name=\"r\" urdf=\"r.urdf\" base=\"floating\"/><contact name=\"base\" type=\"6d\" frame=\"r/l0\"/>"
      "<contact name=\"along\" type=\"2d\" frame=\"r/l3\"/></scene>"));
  std::mt19937 rng(44);
  for (int k = 0; k < 20; ++k) {
    Eigen::VectorXd turned = random_vector(file.scene.nv, rng, 1);
    turned[6] = turned[8] = 0;  // the last link stays along x
    const SceneFile posed = moved(file, turned);
    for (Method method : methods_for_dependent_rows()) {
      const Solved s(posed, method);
      EXPECT_EQ(s.report().rank, 7) << to_string(method);
      EXPECT_LE(s.data.a.cwiseAbs().maxCoeff(), 1e3) << to_string(method);
    }
  }
}

// Six rows at the end of a moment arm fix a body for any length of the arm: radians are not metres.
TEST(Rank, DoesNotDependOnLevers) {
  for (const char* lever : {"1e3", "1e5", "1e6", "1e7", "1e8"})
    for (Method method : methods()) {
      const Solved s(
          box("<contact name=\"c\" type=\"6d\" frame=\"r/crate\" offset=\"" + std::string(lever) + " 0 0\"/>"), method);
      if (method == Method::kDenseSchur && s.report().status == Status::kFailed) continue;  // the baseline may fail
      EXPECT_EQ(s.report().rank, 6) << lever << " " << to_string(method);
      EXPECT_LE(s.data.a.cwiseAbs().maxCoeff(), 1e-6 * 9.81) << lever << " " << to_string(method);
    }
}

// Points that nearly coincide leave small pivots, whose rounding errors must not count as independent rows.
TEST(Rank, OfPointsThatNearlyCoincideIsNoneOfRounding) {
  for (double apart : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5}) {
    const auto point = [&](const char* name, double at) {
      return "<contact name=\"" + std::string(name) + "\" type=\"3d\" frame=\"r/crate\" offset=\"0.3 " +
             std::to_string(at) + " 0.1\"/>";
    };
    const SceneFile file = box(point("a", 0) + point("b", apart) + point("c", 2 * apart));  // on a line: rank 5
    for (Method method : methods_for_dependent_rows()) {
      const Solved s(file, method);
      EXPECT_EQ(s.report().rank, 5) << apart << " " << to_string(method);
      EXPECT_EQ(s.report().status, Status::kRedundant) << apart << " " << to_string(method);
    }
  }
}

// Along a limb, accepted rows after dependent rows on one body are compared with the error of the small pivot.
TEST(Rank, OfRowsAfterASmallPivotIsNoneOfRounding) {
  const TemporaryFolder folder;
  LinksFile links(1, 0.1);
  links.add(0, "xyz=\"0.3 0 0\"", "1 0 0");
  links.add(1, "xyz=\"0.04 -0.7 0.45\"", "0 1 0");
  links.add(2, "xyz=\"0.3 0.1 0\"", "0.6 0 0.8");
  links.add(3, "xyz=\"0.2 0 0.3\"", "0 0.6 0.8");
  (void)folder.write("r.urdf", links.text());
  const auto up = [](const char* name, const char* at) {
    return "<contact name=\"" + std::string(name) +
           "\" type=\"1d\" axis=\"0 0 1\" reference_frame=\"world\" frame=\"r/" + at + "/>";
  };
  const SceneFile file = load_scene(
      folder.write("scene.xml",
                   "<scene><robot name=\"r\" urdf=\"r.urdf\" base=\"floating\"/>"
                   "<contact name=\"a\" type=\"5d\" axis=\"1 0 0\" frame=\"r/l3\" offset=\"-0.2 -0.3 0.07\"/>"
                   "<contact name=\"b\" type=\"5d\" axis=\"1 0 0\" frame=\"r/l3\" offset=\"-0.2 -0.30001 0.07\"/>" +
                       up("c", "l4\" offset=\"-0.3 -0.04 0.2\"") + up("d", "l4\" offset=\"-0.3 -0.04 0.2001\"") +
                       up("e", "l3\"") + "</scene>"));
  std::mt19937 rng(45);
  for (int k = 0; k < 20; ++k) {
    const SceneFile posed = moved(file, random_vector(file.scene.nv, rng, 1));
    const int rank = Solved(posed, Method::kDense).report().rank;
    for (Method method : methods_for_dependent_rows())
      EXPECT_EQ(Solved(posed, method).report().rank, rank) << to_string(method);
  }
}

// Two pairs of rows at one point, in different axes: three of the four are independent, however light the body.
TEST(Rank, OfRowsOnOneBodyDoesNotDependOnItsMass) {
  for (const double mass : {1.0, 1e-6, 1e-12}) {
    SceneFile file =
        box("<contact name=\"a\" type=\"2d\" frame=\"r/crate\" offset=\"0.1 0.2 0.1\" reference_frame=\"local\"/>"
            "<contact name=\"b\" type=\"2d\" frame=\"r/crate\" offset=\"0.1 0.2 0.1\" "
            "reference_frame=\"local_world_aligned\"/>");
    Model model = *file.scene.robots[0].model;
    model.joints[0].inertia = Inertia<double>::from_com(mass, {0, 0, 0}, 0.1 * mass * Mat3<double>::Identity());
    file.scene.robots[0].model = std::make_shared<const Model>(std::move(model));
    std::mt19937 rng(47);
    disturb(file, rng, 0.5);
    for (Method method : methods_for_dependent_rows())
      EXPECT_EQ(Solved(file, method).report().rank, 3) << mass << " " << to_string(method);
  }
}

// Millimetres and metres mix: the residual of a row is as accurate with a short moment arm as with a long one.
TEST(Rank, DoesNotDependOnUnits) {
  for (const char* y : {"1", "1e-3", "1e-5"}) {
    const SceneFile file =
        box("<contact name=\"far\" type=\"3d\" frame=\"r/crate\" offset=\"1e2 0 0\"/>"
            "<contact name=\"near\" type=\"2d\" frame=\"r/crate\" offset=\"0 " +
            std::string(y) + " 0\"/>");
    for (Method method : methods_for_dependent_rows())
      EXPECT_EQ(Solved(file, method).report().rank, 5) << y << " " << to_string(method);
  }
}

// The rows of a body's origin on the axis of a distant joint are rounding errors of the joint's moment arm.
TEST(Rank, OfAPointOnTheAxisIsNone) {
  for (const char* along : {"0.1 0.2 0.3", "0.7 -0.1 0.3", "-0.3 0.4 0.2", "0.11 0.23 -0.37"}) {
    const TemporaryFolder folder;
    LinksFile links(1, 0.01);
    links.add(0, "xyz=\"" + std::string(along) + "\"", along);
    (void)folder.write("r.urdf", links.text());
    for (const char* type : {"3d\"", "5d\" axis=\""}) {
      const std::string axis = type[0] == '5' ? std::string(along) + "\"" : "";
      const SceneFile file = load_scene(folder.write(
          "scene.xml",
          "<scene><robot name=\"r\" urdf=\"r.urdf\" base=\"floating\"><q>0 0 0 0.1 0.2 0.3 0.9273618495495703 0.4</q>"
          "</robot><contact name=\"c\" frame=\"r/l0\" to=\"r/l1\" type=\"" +
              std::string(type) + axis + "/></scene>"));
      for (Method method : methods_for_dependent_rows())
        EXPECT_EQ(Solved(file, method).report().rank, 0) << along << " " << type << " " << to_string(method);
    }
  }
}

// A point of two links that move in a plane has two independent rows; the residual of the third is a rounding error.
TEST(Rank, OfThePlaneIsTwo) {
  const TemporaryFolder folder;
  const auto link = [](const std::string& name, const std::string& mass, const std::string& inertia) {
    return "<link name=\"" + name + "\"><inertial>" + mass + "<inertia " + inertia +
           " ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>";
  };
  (void)folder.write(
      "r.urdf",
      "<robot name=\"r\">" + link("l0", "<mass value=\"1\"/>", "ixx=\"1\" iyy=\"1\" izz=\"1\"") +
          link("l1", "<mass value=\"0.3\"/>", "ixx=\"0.001\" iyy=\"0.005\" izz=\"0.004\"") +
          link("l2", "<origin xyz=\"0.07 -0.03 0.1\"/><mass value=\"1\"/>", "ixx=\"0.002\" iyy=\"0.01\" izz=\"0.01\"") +
          "<joint name=\"a\" type=\"planar\"><parent link=\"l0\"/><child link=\"l1\"/><origin xyz=\"0.1 0.5 0.2\"/>"
          "<axis xyz=\"0 0 1\"/></joint><joint name=\"b\" type=\"planar\"><parent link=\"l1\"/><child link=\"l2\"/>"
          "<origin xyz=\"0.3 0.06 0.3\" rpy=\"1.4004361542297077 -1.6068394506663188 0.94514435019825693\"/>"
          "<axis xyz=\"0 0 1\"/></joint></robot>");
  const SceneFile file = load_scene(folder.write(
      "scene.xml",
      "<scene><robot name=\"r\" urdf=\"r.urdf\" base=\"fixed\"><q>-0.91088461112719799 0.80610609338485772 "
      "-1.0320524128247268 1.9086012717209515 0.17979884630966381 -1.6671061164160224</q></robot><contact name=\"c\" "
      "type=\"3d\" frame=\"r/l1\" to=\"r/l2\"/></scene>"));
  for (Method method : methods_for_dependent_rows())
    EXPECT_EQ(Solved(file, method).report().rank, 2) << to_string(method);
}

// An inconsistency of micrometres must not count as a rounding error of radians, and derivatives have its term.
TEST(Contradiction, OfMicrometresIsNoRoundingOfTurns) {
  const TemporaryFolder folder;
  LinksFile links(0.001, 1e-10);
  links.add(0, "", "0 0 1");
  (void)folder.write("r.urdf", links.text());
  SceneFile file = load_scene(folder.write(
      "scene.xml",
      "<scene gravity=\"0 0 0\"><robot name=\"r\" urdf=\"r.urdf\" base=\"fixed\"><q>0.5</q></robot>"
      "<contact name=\"c\" type=\"1d\" axis=\"0 1 0\" frame=\"r/l1\" offset=\"1e-6 0 0\" reference_frame=\"world\" "
      "gains=\"25 0\"/><contact name=\"d\" type=\"1d\" axis=\"0 1 0\" frame=\"r/l1\" offset=\"0 1e-6 0\" "
      "reference_frame=\"world\" gains=\"25 0\"/></scene>"));
  file.scene.contacts[1].B.placement.p[1] += 5e-14;
  constexpr double kStep = 1e-5;
  const Eigen::VectorXd step = Eigen::VectorXd::Constant(1, kStep);
  for (Method method : methods_for_dependent_rows()) {
    Solved s(file, method);
    EXPECT_EQ(s.report().status, Status::kInconsistent) << to_string(method);
    differentiate(s.file.scene, s.data);
    SceneFile before = file, after = file;
    before.q -= step, after.q += step;
    const double difference = (Solved(after, method).data.a[0] - Solved(before, method).data.a[0]) / (2 * kStep);
    EXPECT_NEAR(dense_derivatives(s.file.scene, s.data).da_dq(0, 0) / difference, 1, 5e-9) << to_string(method);
  }
}

// With nearly massless links, the cancellation in a single solve must not count as K's condition.
TEST(Condition, BesideTinyMasses) {
  SceneFile file = box(
      "<contact name=\"c\" type=\"5d\" axis=\"-0.38 -1.38 -0.81\" frame=\"r/crate\"/>"
      "<contact name=\"d\" type=\"3d\" frame=\"r/crate\" offset=\"0.136 -0.097 0.145\" reference_frame=\"world\"/>");
  Model model = *file.scene.robots[0].model;
  model.joints[0].inertia = Inertia<double>::from_com(7.8e-16, {0, 0, 0}, 1e-10 * Mat3<double>::Identity());
  file.scene.robots[0].model = std::make_shared<const Model>(std::move(model));
  std::mt19937 rng(42);
  for (int k = 0; k < 10; ++k) {
    disturb(file, rng, 0.5);
    Solved right(file, Method::kDense);
    estimate_condition(right.file.scene, right.data);
    for (Method method : methods_for_dependent_rows()) {
      Solved s(file, method);
      estimate_condition(s.file.scene, s.data);
      EXPECT_NEAR(s.report().condition / right.report().condition, 1, 0.5) << to_string(method);
    }
  }
}

// Gravity is rotated with the body, although a horizontal row in world axes is free of it: bounds include the residual.
TEST(Bounds, CountGravityAcrossARow) {
  SceneFile file = load_text(
      "<scene gravity=\"0 0 -6.7e5\"><robot name=\"q\" urdf=\"quadruped.urdf\" base=\"floating\"/>"
      "<contact name=\"c\" type=\"1d\" frame=\"q/LF_shank\" offset=\"0.1 0.2 0.15\" reference_frame=\"world\" "
      "axis=\"1 0 0\" gains=\"187 1.6\"/></scene>");
  std::mt19937 rng(43);
  for (int k = 0; k < 5; ++k) {
    disturb(file, rng, 0.5);
    for (Method method : methods_for_dependent_rows()) expect_true_bounds(Solved(file, method), "gravity");
  }
}

// A row was dropped with a residual of 5e-12; dropping another one in its place would leave as much.
TEST(Bounds, CountWhatDroppedRowsLeave) {
  for (const char* apart : {"0", "5e-12"}) {
    SceneFile file =
        box("<contact name=\"one\" type=\"3d\" frame=\"r/crate\" offset=\"0.3 0 0\"/>"
            "<contact name=\"two\" type=\"1d\" axis=\"1 0 0\" frame=\"r/crate\" offset=\"0.3 0 " +
            std::string(apart) + "\"/>");
    file.v << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6;
    for (Method method : methods_for_dependent_rows()) {
      SCOPED_TRACE(to_string(method) + " " + apart);
      Solved s(file, method);
      estimate_errors(s.file.scene, s.data);
      EXPECT_EQ(s.report().rank, 3);
      for (const double bound : {s.report().error_acceleration, s.report().error_forces})
        EXPECT_EQ(bound > 1e-12, apart != std::string("0")) << bound;
    }
  }
}

// Accelerations of a scene at rest, and forces of one without loads, are rounding errors. The status must not change.
TEST(Bounds, OfWhatVanishesKeepTheStatus) {
  const SceneFile rests = box("<contact name=\"one\" type=\"6d\" frame=\"r/crate\" offset=\"0.3 0.1 0.2\"/>");
  const SceneFile falls =
      box("<contact name=\"one\" type=\"1d\" axis=\"0.6 0.8 0\" frame=\"r/crate\" offset=\"0.1 0.2 0.3\"/>");
  for (Method method : methods_for_dependent_rows()) {
    SCOPED_TRACE(to_string(method));
    for (const SceneFile& file : {rests, falls}) {
      Solved s(file, method);
      estimate_errors(s.file.scene, s.data);
      EXPECT_EQ(s.report().status, Status::kOk);
    }
  }
}

// Six rows span those of 120 points on one body, at a cost linear in the number of points.
TEST(ManyContacts, OnOneBodyAreReducedToSixRows) {
  std::string contacts;
  for (int k = 0; k < 120; ++k) {
    const std::string x = std::to_string(0.01 * (k % 12)), y = std::to_string(0.013 * (k / 12));
    contacts +=
        "<contact name=\"c" + std::to_string(k) + "\" type=\"3d\" frame=\"r/crate\" offset=\"" + x + " " + y + " 0\"/>";
  }
  const SceneFile file = box(contacts);
  Solved s(file, Method::kAuto);
  EXPECT_NE(s.report().islands[0].method, Method::kDense);
  EXPECT_EQ(s.report().islands[0].reason, Reason::kNone);
  EXPECT_EQ(s.report().rank, 6);
  EXPECT_EQ(s.report().status, Status::kRedundant);
  const Solved sparse(file, Method::kSparseLdl);
  EXPECT_LE((s.data.f - sparse.data.f).cwiseAbs().maxCoeff(), 1e-9 * s.data.f.cwiseAbs().maxCoeff());
  (void)differentiate(s.file.scene, s.data);
  EXPECT_TRUE(dense_derivatives(s.file.scene, s.data).dforces_dq.allFinite());
}

}  // namespace
}  // namespace manycontact::test
