// These scenes define how exact they are: rows that are dependent to within it are dependent in all results. Rows that
// were dependent at the start of a motion remain so despite constraint violations.

#include <cmath>
#include <filesystem>

#include "manycontact/detail/simulation/invariants.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/simulation/step.hpp"
#include "support/folder.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

const SceneData& solved(const SceneFile& file, SceneData& data) {
  (void)solve(file.scene, file.q, file.v, file.u, data);
  return data;
}

double apart(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

SceneFile moving(double tilt, const std::string& type) {
  SceneFile file = tilted_four_bar(tilt, type);
  // The motion is in the plane of the loop: J v = 0 for the pin's first two rows, the only ones without a tilt.
  const SceneFile plane = tilted_four_bar(0, type);
  SceneData at_rest(plane.scene);
  file.v = solved(plane, at_rest).a;
  return file;
}

TEST(Tolerance, ALoopThatIsPlaneButForItMoves) {
  for (const std::string type : {"3d", "5d"})
    for (const double tilt : {3e-6, 1e-4}) {
      SceneFile file = moving(tilt, type), plane = file;
      const SceneFile untilted = tilted_four_bar(0, type);
      plane.scene = untilted.scene;
      SceneData locked(file.scene), truth(plane.scene);
      EXPECT_EQ(solved(file, locked).report.rank, 3) << type;
      ASSERT_EQ(solved(plane, truth).report.rank, 2) << type;
      file.scene.tolerance = 3 * tilt;
      SceneData oracle(file.scene, {Method::kDense, {}});
      ASSERT_EQ(solved(file, oracle).report.status, Status::kRedundant) << type;
      const Eigen::MatrixXd truth_D = sparse_derivatives(plane.scene, (differentiate(plane.scene, truth), truth));
      for (const Way& way : ways_here(true)) {
        if (way.options.method == Method::kDenseSchur) continue;  // it has no solution where rows are dependent
        SceneData data(file.scene, way.options);
        EXPECT_EQ(solved(file, data).report.status, Status::kRedundant) << way.name;
        EXPECT_EQ(data.report.rank, 2) << way.name;
        EXPECT_LT(apart(data.a, truth.a), 30 * tilt) << type << way.name;
        EXPECT_LT(apart(data.f, truth.f), 30 * tilt) << type << way.name;
        EXPECT_LT(apart(data.a, oracle.a), 1e-11) << way.name;
        EXPECT_LT(apart(data.f, oracle.f), 1e-10) << way.name;
        differentiate(file.scene, data);
        const Eigen::MatrixXd D = sparse_derivatives(file.scene, data);
        EXPECT_LT(apart(D, truth_D), 300 * tilt) << type << way.name;
      }
    }
}

TEST(Tolerance, NothingIsTakenThatExceedsIt) {
  SceneFile file = tilted_four_bar(1e-3);
  SceneData without(file.scene);
  const Eigen::VectorXd a = solved(file, without).a, f = without.f;
  file.scene.tolerance = 1e-5;
  SceneData with(file.scene);
  EXPECT_EQ(solved(file, with).report.status, Status::kOk);
  EXPECT_EQ(with.report.rank, 3);
  EXPECT_LT((with.a - a).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(apart(with.f, f), 1e-9);
}

// Ordinary scenes have no nearly dependent rows: the solutions are the same, from the whole K.
TEST(Tolerance, OrdinaryScenesAreTheSame) {
  for (const std::string& path : model_scenes()) {
    SceneFile file = load_small(path);
    SceneData without(file.scene);
    const Status status = solved(file, without).report.status;
    file.scene.tolerance = 1e-6;
    SceneData with(file.scene);
    EXPECT_EQ(solved(file, with).report.status, status) << path;
    EXPECT_EQ(with.report.rank, without.report.rank) << path;
    EXPECT_LT((with.a - without.a).cwiseAbs().maxCoeff(), 1e-9 * 9.81) << path;  // some scenes are at rest
    EXPECT_LT(apart(with.f, without.f), 1e-9) << path;
  }
}

TEST(Tolerance, ProductsAreThoseOfTheDerivatives) {
  SceneFile file = moving(1e-5, "5d");
  file.scene.tolerance = 1e-4;
  SceneData data(file.scene);
  ASSERT_EQ(solved(file, data).report.rank, 2);
  differentiate(file.scene, data);
  const Eigen::MatrixXd D = sparse_derivatives(file.scene, data);
  std::mt19937 rng(1);
  const int nv = file.scene.nv, nu = file.scene.nu;
  const Eigen::VectorXd dx = random_vector(2 * nv + nu, rng);
  Eigen::VectorXd da(nv), df(data.f.size());
  jvp(file.scene, data, dx.head(nv), dx.segment(nv, nv), dx.tail(nu), da, df);
  Eigen::VectorXd both(nv + df.size());
  both << da, df;
  EXPECT_LT(apart(both, D * dx), 1e-12);
}

// A box, of which contacts have more rows than its six coordinates.
std::string box_in(const TemporaryFolder& folder) {
  return folder.write("box.urdf",
                      "<robot name=\"b\"><link name=\"b\"><inertial><mass value=\"2\"/><inertia ixx=\"0.1\" ixy=\"0\" "
                      "ixz=\"0\" iyy=\"0.2\" iyz=\"0\" izz=\"0.25\"/></inertial></link></robot>");
}

// The rows of c1 have no part in the dependence, and b's coordinates have no other rows.
TEST(Tolerance, RowsOfOtherContactsAreLeftAlone) {
  const TemporaryFolder folder;
  (void)box_in(folder);
  SceneFile file = load_scene(folder.write("scene.xml", R"(<scene name="two">
  <robot name="a" urdf="box.urdf" base="floating" rpy="1.2 0.2 0.5"/>
  <robot name="b" urdf="box.urdf" base="floating" xyz="1 0 0"/>
  <contact name="c0" type="1d" frame="a/b" offset="0 0.6 0.1" axis="0 0 1"/>
  <contact name="c1" type="2d" frame="a/b" offset="0.6 0.1 -0.1" to="b/b"/>
  <contact name="c2" type="6d" frame="a/b" offset="0.3 0.9 0.2"/>
</scene>)"));
  SceneData without(file.scene);
  ASSERT_EQ(solved(file, without).report.rank, 8);
  for (const double tolerance : {1e-15, 1e-10, 1e-6, 1e-3})
    for (const Way& way : ways_here(true)) {
      if (way.options.method == Method::kDenseSchur) continue;
      file.scene.tolerance = tolerance;
      SceneData with(file.scene, way.options);
      EXPECT_EQ(solved(file, with).report.rank, 8) << way.name;
      EXPECT_LT(apart(with.a, without.a), 1e-12) << way.name;
      EXPECT_LT(apart(with.f, without.f), 1e-12) << way.name;
    }
}

// A floating four-bar mechanism of which another contact holds a point.
SceneFile held_four_bar(double tilt) {
  const TemporaryFolder folder;
  const auto link = [](const std::string& name, const std::string& mass) {
    return "<link name=\"" + name + "\"><inertial><origin xyz=\"0 0 0.15\"/><mass value=\"" + mass +
           "\"/><inertia ixx=\"0.02\" iyy=\"0.03\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>";
  };
  const auto joint = [](const std::string& from, const std::string& to, const std::string& z, double x) {
    return "<joint name=\"to_" + to + "\" type=\"continuous\"><parent link=\"" + from + "\"/><child link=\"" + to +
           "\"/><origin xyz=\"0 0 " + z + "\"/><axis xyz=\"" + std::to_string(x) + " 1 0\"/></joint>";
  };
  (void)folder.write("bars.urdf", "<robot name=\"bars\">" + link("ground", "5") + link("crank", "1") +
                                      link("coupler", "1") + link("rocker", "1") + joint("ground", "crank", "0", 0) +
                                      joint("crank", "coupler", "0.3", tilt) +
                                      joint("coupler", "rocker", "0.5", -tilt / 2) + "</robot>");
  return load_scene(folder.write("scene.xml", R"(<scene name="four_bar">
  <robot name="bars" urdf="bars.urdf" base="floating"> <q>0 0 0 0 0 0 1  0.2 1.2 1.6</q> </robot>
  <contact name="pin" type="3d" frame="bars/rocker" offset="0 0 0.4" to="bars/ground"/>
  <contact name="held" type="3d" frame="bars/rocker" offset="0 0 0.4"/>
</scene>)"));
}

TEST(Tolerance, ALoopMovesThatAnotherContactHolds) {
  constexpr double kTilt = 2e-5;
  SceneFile plane = held_four_bar(0), file = held_four_bar(kTilt);
  SceneData truth(plane.scene);
  ASSERT_EQ(solved(plane, truth).report.rank, 5);
  file.scene.tolerance = 1e-4;
  for (const Way& way : ways_here(true)) {
    if (way.options.method == Method::kDenseSchur) continue;
    SceneData data(file.scene, way.options);
    EXPECT_EQ(solved(file, data).report.status, Status::kRedundant) << way.name;
    EXPECT_EQ(data.report.rank, 5) << way.name;
    EXPECT_LT(apart(data.a, truth.a), 30 * kTilt) << way.name;
    EXPECT_LT(apart(data.f, truth.f), 30 * kTilt) << way.name;
    EXPECT_LT(data.report.residual_dynamics, 2 * file.scene.tolerance) << way.name;
  }
}

// The residual of the report is that of the rows as they were: forces times the change of J, which the file states.
TEST(Tolerance, TheResidualHasTheChange) {
  SceneFile file = moving(1e-4, "5d");
  SceneData exact(file.scene);
  EXPECT_LT(solved(file, exact).report.residual_dynamics, 1e-12);
  file.scene.tolerance = 3e-4;
  SceneData data(file.scene);
  ASSERT_EQ(solved(file, data).report.rank, 2);
  EXPECT_GT(data.report.residual_dynamics + data.report.residual_contact, 1e-9);
  EXPECT_LT(data.report.residual_dynamics, 3e-4);
  estimate_errors(file.scene, data);
  EXPECT_GT(data.report.error_acceleration + data.report.error_forces, 1e-9);
}

// b1 has one row more than it needs, and b0 hangs on it: its rows have no part in that.
TEST(KeptDependent, ABoxThatHangsOnAnother) {
  const TemporaryFolder folder;
  (void)box_in(folder);
  const SceneFile file = load_scene(folder.write("scene.xml", R"(<scene name="hanging">
  <robot name="b0" urdf="box.urdf" base="floating" xyz="0 0 0" rpy="-0.2 0.6 -0.3"/>
  <robot name="b1" urdf="box.urdf" base="floating" xyz="1 0 0" rpy="-1.8 0 -0.2"/>
  <contact name="c0" type="2d" frame="b0/b" offset="-0.1 0.4 0.3" to="b1/b"/>
  <contact name="c1" type="5d" frame="b1/b" offset="-0.5 1.1 -0.2" axis="0 0 1"/>
  <contact name="c2" type="2d" frame="b1/b" offset="0.2 0.1 -0.4"/>
  <contact name="c3" type="1d" frame="b1/b" offset="0.4 0 0.1" axis="0 1 0" reference_frame="world"/>
</scene>)"));
  SimulationData data(file.scene, file.q, file.v, Integrator::kRk4, 1e-3);
  for (int k = 0; k < 20; ++k) ASSERT_EQ(step(file.scene, file.u, data), StepStatus::kOk);
  SimulationData dense(file.scene, file.q, file.v, Integrator::kRk4, 1e-3, {Method::kDense, {}});
  for (int k = 0; k < 20; ++k) ASSERT_EQ(step(file.scene, file.u, dense), StepStatus::kOk);
  EXPECT_LT(apart(data.v, dense.v), 1e-9);
  // c0's rows turn with A, and steps keep J v. Semi-implicit Euler goes to the same with h, in the first order.
  InvariantsData room(file.scene);
  EXPECT_LT(invariants(file.scene, data.dynamics.active, data.q, data.v, room).violation_velocity, 1e-14);
  EXPECT_NEAR(data.v[3], 0.317067178445, 1e-9);
}

// Bricard's mechanism has one row more than it needs, and only on its closed loop.
TEST(KeptDependent, BricardMoves) {
  const std::string folder = MANYCONTACT_SHARED_DIR "/mechanisms/03-bricard/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no " << folder;
  for (const char* name : {"scene_5d.xml", "scene_2x3d.xml"})
    for (const Integrator integrator : {Integrator::kRk4, Integrator::kSemiImplicitEuler}) {
      const SceneFile file = load_scene(folder + name);
      SimulationData data(file.scene, file.q, file.v, integrator, 1e-3);
      const double within = integrator == Integrator::kRk4 ? 5e-5 : 3e-3;
      for (const double at_second : {1.0350, 2.8933}) {
        for (int k = 0; k < 1000; ++k) ASSERT_EQ(step(file.scene, file.u, data), StepStatus::kOk) << name;
        EXPECT_NEAR(data.q[0], at_second, within) << name;
        EXPECT_EQ(data.dynamics.report.rank, file.scene.nv - 1) << name;
      }
    }
}

}  // namespace
}  // namespace manycontact::test
