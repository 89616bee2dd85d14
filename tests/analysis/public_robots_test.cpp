// Public robots of ../shared/public all load unchanged, and their accelerations are Pinocchio's.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/dynamics/solve.hpp"

namespace manycontact::test {
namespace {

namespace fs = std::filesystem;

constexpr double kTolerance = 1e-9;  // relative to the largest acceleration, given by the issue

// Returns the largest difference divided by the largest value.
double relative_error(const Eigen::VectorXd& x, const std::vector<double>& expected) {
  const Eigen::Map<const Eigen::VectorXd> y(expected.data(), static_cast<Eigen::Index>(expected.size()));
  return (x - y).lpNorm<Eigen::Infinity>() / y.lpNorm<Eigen::Infinity>();
}

TEST(PublicRobots, AccelerationsOfPinocchio) {
  const fs::path folder = fs::path(MANYCONTACT_SHARED_DIR) / "public";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not here";
  int count = 0;
  std::set<std::string> kinds;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".xml") continue;
    SCOPED_TRACE(entry.path().filename());
    ++count;
    const auto expected = nlohmann::json::parse(std::ifstream(fs::path(entry.path()).replace_extension(".json")));
    SceneFile file;
    ASSERT_NO_THROW(file = load_scene(entry.path().string()));
    EXPECT_EQ(velocity_names(file.scene), expected.at("velocity_names").get<std::vector<std::string>>());
    SceneData data(file.scene);
    ASSERT_EQ(solve(file.scene, file.q, file.v, file.u, data).status, Status::kOk);
    EXPECT_LT(relative_error(data.a, expected.at("acceleration").get<std::vector<double>>()), kTolerance);
    for (const Finding& f : file.findings) {
      kinds.insert(f.kind);
      EXPECT_TRUE(fs::exists(f.file)) << f.file;
      EXPECT_GE(f.line, 1);
      EXPECT_FALSE(f.text.empty());
    }
  }
  EXPECT_GE(count, 36);
  for (const char* kind : {"inertia", "limits", "mimic"}) EXPECT_TRUE(kinds.count(kind)) << kind;
}

}  // namespace
}  // namespace manycontact::test
