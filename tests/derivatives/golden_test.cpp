// Derivatives agree with Crocoddyl's, and with differences of Pinocchio's terms, for real robots in random states.

#include "support/golden.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "spatial/compare.hpp"
#include "support/methods.hpp"

namespace manycontact::test {
namespace {

constexpr double kAnalytical = 1e-8, kByDifferences = 1e-6;
constexpr char kAbsent[] = "absent";  // replaces all files when there are none

constexpr std::array<const char*, 6> kKeys = {"da_dq", "da_dv", "da_du", "dforces_dq", "dforces_dv", "dforces_du"};
using Matrices = std::array<Eigen::MatrixXd, 6>;

std::vector<std::string> files() {
  const std::vector<std::string> paths = golden_scenes();
  return paths.empty() ? std::vector<std::string>{kAbsent} : paths;
}

std::string file_name(const testing::TestParamInfo<std::string>& info) { return scene_name(info.param); }

Eigen::MatrixXd to_matrix(const nlohmann::json& rows, Eigen::Index columns) {
  Eigen::MatrixXd m(rows.size(), columns);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].size(), static_cast<std::size_t>(columns));
    for (Eigen::Index j = 0; j < columns; ++j) m(i, j) = rows[i].at(j);
  }
  return m;
}

Matrices figures(const Golden& golden, const Scene& scene) {
  Matrices out;
  for (int k = 0; k < 6; ++k) out[k] = to_matrix(golden.json.at(kKeys[k]), k % 3 == 2 ? scene.nu : scene.nv);
  return out;
}

// Returns the errors of all six; NaN if the method has no solution.
std::array<double, 6> errors(const Scene& scene, const SceneFile& file, const Options& options, const Matrices& truth) {
  SceneData data(scene, options);
  (void)solve(scene, file.q, file.v, file.u, data);
  differentiate(scene, data);
  const SceneDerivatives d = dense_derivatives(scene, data);
  const Eigen::MatrixXd* mine[] = {&d.da_dq, &d.da_dv, &d.da_du, &d.dforces_dq, &d.dforces_dv, &d.dforces_du};
  std::array<double, 6> out;
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(mine[k]->rows(), truth[k].rows()) << kKeys[k];
    EXPECT_EQ(mine[k]->cols(), truth[k].cols()) << kKeys[k];
    out[k] = error_of(*mine[k], truth[k]);
  }
  return out;
}

class GoldenDerivatives : public testing::TestWithParam<std::string> {};

TEST_P(GoldenDerivatives, EveryMethod) {
  if (GetParam() == kAbsent) GTEST_SKIP() << "no figures in " MANYCONTACT_SHARED_DIR "/golden";
  const Golden golden = load_golden(GetParam());
  if (!golden.json.contains("da_dq")) GTEST_SKIP() << "no derivatives in this file";
  const SceneFile file = load_scene(GetParam());
  const bool analytical = golden.json.at("derivatives_by") == "analytical";
  const double allowed = analytical ? kAnalytical : kByDifferences;
  const Matrices truth = figures(golden, file.scene);
  EXPECT_GT(size_of(truth[0]), 1);
  Scene scene = file.scene;
  // Figures computed on models with Pinocchio's error (see as_appended_by_pinocchio_3_7) agree with the same error put
  // in. Once they are corrected, this branch is never taken.
  if (golden.appended && !(errors(scene, file, {Method::kDense, {}}, truth)[0] <= allowed)) {
    EXPECT_GT(errors(scene, file, {Method::kDense, {}}, truth)[0], 1e-4);
    scene = as_appended_by_pinocchio_3_7(scene);
  }
  double worst = 0;
  for (const Way& way : ways(true)) {
    const std::array<double, 6> e = errors(scene, file, way.options, truth);
    for (int k = 0; k < 6; ++k) {
      EXPECT_LE(e[k], allowed) << way.name << ' ' << kKeys[k];
      worst = std::max(worst, e[k]);
    }
  }
  EXPECT_GT(worst, 0);
  std::printf("%s: %.1e of %.0e\n", scene_name(GetParam()).c_str(), worst, allowed);
}

INSTANTIATE_TEST_SUITE_P(Files, GoldenDerivatives, testing::ValuesIn(files()), file_name);

}  // namespace
}  // namespace manycontact::test
