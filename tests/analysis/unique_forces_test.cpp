// Unique forces are compared with the null space of J^T from a dense decomposition, and with published cases.

#include "manycontact/analysis/unique_forces.hpp"

#include <cmath>

#include "manycontact/analysis/rank_changes.hpp"
#include "support/dense.hpp"
#include "support/methods.hpp"
#include "support/scenes.hpp"
#include "support/terms.hpp"

namespace manycontact::test {
namespace {

std::vector<char> unique_in(const SceneFile& file, Method method = Method::kAuto) {
  SceneData data(file.scene, {method, {}});
  (void)solve(file.scene, file.q, file.v, file.u, data);
  return unique_forces(file.scene, file.q, data);
}

// Uses the singular vectors of J^T: a component is unique if it is zero in every null vector.
std::vector<char> by_svd(const SceneFile& file) {
  std::vector<char> active;
  for (const Contact& contact : file.scene.contacts) active.push_back(contact.active);
  const Terms t(file.scene, active, file.q, file.v, file.u);
  const Svd svd(t.J.transpose());
  Eigen::Index rank = 0;
  while (rank < svd.sigma.size() && svd.sigma[rank] > 1e-9 * svd.sigma[0]) ++rank;
  const Eigen::MatrixXd N = svd.V.rightCols(t.J.rows() - rank);
  std::vector<char> unique;
  for (Eigen::Index k = 0; k < t.J.rows(); ++k) unique.push_back(N.row(k).norm() < 1e-7);
  return unique;
}

SceneFile door(const std::string& type) {
  const auto hinge = [&](const char* name, const char* z) {
    return "<contact name=\"" + std::string(name) + "\" type=\"" + type + "\" frame=\"b/crate\" offset=\"-0.2 0 " + z +
           "\"/>";
  };
  return load_text("<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>" + hinge("lower", "-0.2") +
                   hinge("upper", "0.2") + "</scene>");
}

// On balls only the shares of the weight are not unique; on hinges only the lateral force without moment arm is unique.
TEST(UniqueForces, OfADoor) {
  EXPECT_EQ(unique_in(door("3d")), (std::vector<char>{1, 1, 0, 1, 1, 0}));
  EXPECT_EQ(unique_in(door("5d")), by_svd(door("5d")));
  EXPECT_EQ(unique_in(door("6d")), std::vector<char>(12, 0));
}

TEST(UniqueForces, AreAllWhereRowsAreIndependent) {
  const SceneFile file = load_scene(kModels + "humanoid_standing.xml");
  const std::vector<char> unique = unique_in(file);
  EXPECT_EQ(unique, std::vector<char>(unique.size(), 1));
  SceneFile damped = door("3d");
  damped.scene.damping = 1e-6;
  EXPECT_EQ(unique_in(damped), std::vector<char>(6, 1));
}

// All methods agree, in scenes of several islands and with other contacts in the island.
TEST(UniqueForces, AgreeWithTheNullSpace) {
  const std::string contacts =
      "<contact name=\"a\" type=\"6d\" frame=\"q0/LF_foot\"/><contact name=\"b\" type=\"3d\" frame=\"q0/RH_foot\"/>"
      "<contact name=\"c\" type=\"5d\" frame=\"q0/trunk\" axis=\"1 0 0\"/><contact name=\"d\" type=\"3d\" "
      "frame=\"q1/LF_foot\"/>"
      "<contact name=\"e\" type=\"6d\" frame=\"q2/LF_foot\"/><contact name=\"f\" type=\"2d\" frame=\"q2/trunk\" "
      "to=\"q3/trunk\"/>"
      "<contact name=\"g\" type=\"3d\" frame=\"q3/trunk\" to=\"q2/trunk\"/>";
  SceneFile file = load_text(
      "<scene><robot name=\"q\" urdf=\"quadruped.urdf\" base=\"floating\" copies=\"4\">"
      "<joint name=\"LF_knee\" q=\"0.4\"/></robot>" +
      contacts + "</scene>");
  const std::vector<char> expected = by_svd(file);
  EXPECT_NE(std::count(expected.begin(), expected.end(), 0), 0);
  EXPECT_NE(std::count(expected.begin(), expected.end(), 1), 0);
  for (const Method method : methods()) {
    if (method == Method::kDenseSchur) continue;
    EXPECT_EQ(unique_in(file, method), expected) << to_string(method);
  }
}

// Unique forces remain unique if redundant contacts are added.
TEST(UniqueForces, StayWhateverIsAdded) {
  for (const char* name : {"feet_on_corners.xml", "quadruped_loop.xml"}) {
    const SceneFile file = load_small(kModels + name);
    EXPECT_EQ(unique_in(file), by_svd(file)) << name;
  }
}

TEST(UniqueForces, NeedAnAnswer) {
  const SceneFile file = door("3d");
  SceneData data(file.scene);
  EXPECT_THROW((void)unique_forces(file.scene, file.q, data), std::logic_error);
}

// Rows that are dependent within a scene's tolerance leave the same forces unique as in the exact scene.
TEST(UniqueForces, AToleranceIsNoForceSharedAtWill) {
  for (const std::string type : {"3d", "5d"}) {
    const SceneFile exact = tilted_four_bar(0, type);
    SceneFile file = tilted_four_bar(3e-6, type);
    file.scene.tolerance = 1e-5;
    SceneData data(file.scene);
    (void)solve(file.scene, file.q, file.v, file.u, data);
    ASSERT_EQ(data.report.rank, 2);
    EXPECT_EQ(unique_forces(file.scene, file.q, data), unique_in(exact)) << type;
    EXPECT_TRUE(rank_changes(file.scene, file.q, data).empty()) << type;
  }
}

}  // namespace
}  // namespace manycontact::test
