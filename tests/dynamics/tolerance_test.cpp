// These scenes define how exact they are: rows that are dependent to within it are dependent in all results. Rows that
// were dependent at the start of a motion remain so despite constraint violations.

#include <cmath>
#include <filesystem>

#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/simulation/step.hpp"
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
