// Configurations whose neighbours have a higher rank are compared with ranks of J there, from a dense decomposition.

#include "manycontact/analysis/rank_changes.hpp"

#include <filesystem>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/contact/jacobian.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/dense.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"
#include "support/several_contacts.hpp"
#include "support/terms.hpp"

namespace manycontact::test {
namespace {

constexpr double kHalf = 1.5707963267948966;

std::vector<RankChange> changes(const SceneFile& file, int rank = -1) {
  SceneData data(file.scene);
  (void)solve(file.scene, file.q, file.v, file.u, data);
  if (rank >= 0) {
    EXPECT_EQ(data.report.rank, rank);
  }
  return rank_changes(file.scene, file.q, data);
}

int rank_at(const SceneFile& file, const Eigen::VectorXd& q) {
  std::vector<char> active;
  for (const Contact& contact : file.scene.contacts) active.push_back(contact.active);
  const Terms t(file.scene, active, q, file.v, file.u);
  return rank_of(t.J, 1e-8);
}

// There are three bars of 0.5, 0.8 and 0.6 m about axes along y.
class Bars {
 public:
  SceneFile load(double q1, double q2, double q3, const std::string& contact) const {
    const auto bar = [](const char* name, const char* z) {
      return "<link name=\"" + std::string(name) + "\"><inertial><origin xyz=\"0 0 " + z +
             "\"/><mass value=\"1\"/><inertia ixx=\"0.02\" ixy=\"0\" ixz=\"0\" iyy=\"0.03\" iyz=\"0\" "
             "izz=\"0.01\"/></inertial></link>";
    };
    const auto joint = [](const char* name, const char* from, const char* to, const char* z) {
      return "<joint name=\"" + std::string(name) + "\" type=\"continuous\"><origin xyz=\"0 0 " + z +
             "\"/><parent link=\"" + from + "\"/><child link=\"" + to + "\"/><axis xyz=\"0 1 0\"/></joint>";
    };
    (void)folder_.write("bars.urdf", "<robot name=\"bars\"><link name=\"base\"/>" + bar("a", "0.25") + bar("b", "0.4") +
                                         bar("c", "0.3") + joint("j1", "base", "a", "0") +
                                         joint("j2", "a", "b", "0.5") + joint("j3", "b", "c", "0.8") + "</robot>");
    SceneFile file =
        load_scene(folder_.write("scene.xml", "<scene><robot name=\"r\" urdf=\"bars.urdf\"/>" + contact + "</scene>"));
    file.q << q1, q2, q3;
    for (Contact& c : file.scene.contacts) resolve_reference(file.scene, file.q, true, true, c);
    return file;
  }

 private:
  TemporaryFolder folder_;
};

const std::string kPin = R"(<contact name="pin" type="2d" frame="r/c" offset="0 0 0.6" reference_frame="world"/>)";

// Flat, the bars point along one line, and the pin's two rows are dependent. Bent, they are independent.
TEST(RankChanges, AFourBarThatLiesFlat) {
  const Bars bars;
  const SceneFile flat = bars.load(0, 0, 2 * kHalf, kPin);
  const auto found = changes(flat, 1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].singular);
  EXPECT_EQ(found[0].rank, 1);
  EXPECT_EQ(found[0].rows, 2);
  EXPECT_EQ(found[0].contacts, std::vector<int>{0});
  EXPECT_GE(found[0].coordinate, 0);
  EXPECT_EQ(rank_at(flat, flat.q + Eigen::Vector3d(1e-3, -2e-3, 1e-3)), 2);
  EXPECT_TRUE(changes(bars.load(0.3, 0.4, 2, kPin), 2).empty());
}

// A straight leg is fixed at both ends: the rows constrain its knee once it bends.
TEST(RankChanges, AStretchedLeg) {
  const Bars bars;
  const std::string knee = R"(<contact name="ankle" type="2d" frame="r/b" offset="0 0 0.8" reference_frame="world"/>)";
  const auto found = changes(bars.load(0, 0, 0.3, knee), 1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].singular);
  EXPECT_TRUE(changes(bars.load(0.2, 0.4, 0.3, knee), 2).empty());
  // at 1e-4 rad from there the rows are independent again
  EXPECT_TRUE(changes(bars.load(0.2, 1e-4, 0.3, knee), 2).empty());
}

// A planar loop closed by a spatial hinge has three redundant rows in every configuration.
TEST(RankChanges, NoneWhereRowsDependEverywhere) {
  const Bars bars;
  const std::string hinge = R"(<contact name="pin" type="5d" axis="0 1 0" frame="r/c" offset="0 0 0.6"/>)";
  EXPECT_TRUE(changes(bars.load(0.3, 0.4, 2, hinge), 2).empty());
  EXPECT_EQ(changes(bars.load(0, 0, 2 * kHalf, hinge), 1).size(), 1u);
  const auto points = [](const std::string& type) {
    return load_text("<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/><contact name=\"l\" type=\"" +
                     type + "\" frame=\"b/crate\"/><contact name=\"u\" type=\"" + type +
                     "\" frame=\"b/crate\" offset=\"0.3 0 0.1\"/></scene>");
  };
  for (const char* type : {"3d", "5d", "6d"}) EXPECT_TRUE(changes(points(type)).empty()) << type;
}

// The finding names its island among several.
TEST(RankChanges, NameTheirIsland) {
  const SceneFile file = load_text(
      "<scene><robot name=\"q\" urdf=\"quadruped.urdf\" base=\"floating\" copies=\"2\">"
      "<joint name=\"LF_knee\" q=\"0.7\"/></robot>"
      "<contact name=\"trunk\" type=\"6d\" frame=\"q1/trunk\"/><contact name=\"straight\" type=\"3d\" "
      "frame=\"q1/RF_foot\"/>"
      "<contact name=\"bent\" type=\"3d\" frame=\"q1/LF_foot\"/></scene>");
  const auto found = changes(file);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].singular);
  EXPECT_EQ(found[0].island, 1u);
  ASSERT_GE(found[0].coordinate, 0);
  EXPECT_EQ(velocity_names(file.scene)[found[0].coordinate].substr(0, 5), "q1/RF");
  EXPECT_EQ(found[0].contacts, (std::vector<int>{0, 1}));
}

TEST(RankChanges, OfPublishedMechanisms) {
  const std::string mechanisms = MANYCONTACT_SHARED_DIR "/mechanisms/";
  if (!std::filesystem::exists(mechanisms)) GTEST_SKIP() << "skipped: no " << mechanisms;
  const auto flat = changes(load_scene(mechanisms + "13-derivatives-at-singular/scene.xml"));
  ASSERT_EQ(flat.size(), 1u);
  EXPECT_TRUE(flat[0].singular);
  EXPECT_EQ(flat[0].rank, 2);  // all bars lie along x: neither pin has a row along it
  // nothing changes along the only motion: rank 5 exists only in broken loops
  const auto bricard = changes(load_scene(mechanisms + "03-bricard/scene_5d.xml"), 4);
  ASSERT_EQ(bricard.size(), 1u);
  EXPECT_FALSE(bricard[0].singular);
}

// Where a change is told, the rank at nearby configurations is another one indeed.
TEST(RankChanges, OfRandomHingesAreTrue) {
  int dependent = 0;
  for (int seed = 0; seed < 1500; ++seed) {
    std::mt19937 rng(seed);
    const RandomScene s = random_hinges(rng);
    SceneData data(s.scene);
    if (solve(s.scene, s.q, s.v, s.u, data).status == Status::kFailed) continue;
    dependent += data.report.rank < data.report.nc;
    const std::vector<RankChange> found = rank_changes(s.scene, s.q, data);
    if (found.empty()) continue;
    const auto rank = [&](const Eigen::VectorXd& q) {
      const Eigen::VectorXd sigma = Svd(contact_jacobian(s.scene, q)).sigma;
      return (sigma.array() > 1e-8).count();
    };
    const Eigen::VectorXd near = integrate(s.scene, s.q, random_vector(s.scene.nv, rng, 1e-3));
    EXPECT_GT(rank(near), rank(s.q)) << "seed " << seed;
  }
  EXPECT_GT(dependent, 700);
}

TEST(RankChanges, NeedAnAnswer) {
  const SceneFile file = load_scene(kModels + "herd.xml");
  EXPECT_THROW((void)rank_changes(file.scene, file.q, SceneData(file.scene)), std::logic_error);
}

}  // namespace
}  // namespace manycontact::test
