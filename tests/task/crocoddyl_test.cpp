// The iterates are Crocoddyl 3.0.1's on the tasks of ../shared/tasks, where these exist.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "manycontact/task/optimize.hpp"

namespace manycontact {
namespace {

namespace fs = std::filesystem;

const fs::path kSharedTasks = MANYCONTACT_SHARED_DIR "/tasks";

std::vector<std::string> names() {
  std::vector<std::string> out;
  if (fs::exists(kSharedTasks))
    for (const auto& entry : fs::directory_iterator(kSharedTasks))
      if (entry.path().extension() == ".json") out.push_back(entry.path().stem().string());
  std::sort(out.begin(), out.end());
  return out;
}

void expect_close(const std::vector<Eigen::VectorXd>& ours, const nlohmann::json& theirs, const std::string& what) {
  ASSERT_EQ(ours.size(), theirs.size()) << what;
  double worst = 0;
  for (std::size_t t = 0; t < ours.size(); ++t) {
    const std::vector<double> x = theirs[t];
    ASSERT_EQ(ours[t].size(), static_cast<Eigen::Index>(x.size())) << what << " " << t;
    for (std::size_t i = 0; i < x.size(); ++i)
      worst = std::max(worst, std::abs(ours[t][static_cast<Eigen::Index>(i)] - x[i]) / std::max(1.0, std::abs(x[i])));
  }
  EXPECT_LE(worst, 1e-5) << what;
}

class Crocoddyl : public testing::TestWithParam<std::string> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Crocoddyl);

// Costs agree to 1e-6 while the stopping value is above 1e-6; below, rounding decides (../shared/tasks).
TEST_P(Crocoddyl, TheSameIterates) {
  nlohmann::json golden;
  std::ifstream(kSharedTasks / (GetParam() + ".json")) >> golden;
  const TaskFile task = read_task((kSharedTasks / (GetParam() + ".xml")).string());
  TaskProblem problem = make_problem(task);
  const TaskSolution solution = optimize(task, problem, {task.solver, 1, {}});

  EXPECT_EQ(solution.converged, golden["converged"]) << solution.reason;
  const nlohmann::json& theirs = golden["iterations"];
  EXPECT_EQ(solution.iterations.size(), theirs.size());
  for (std::size_t k = 0; k < std::min(solution.iterations.size(), theirs.size()); ++k) {
    const TaskIteration& own = solution.iterations[k];
    SCOPED_TRACE("iteration " + std::to_string(k));
    if (theirs[k]["stop"] < 1e-6) continue;
    const double cost = theirs[k]["cost"];
    EXPECT_NEAR(own.cost, cost, 1e-6 * std::abs(cost));
    EXPECT_EQ(own.step_length, theirs[k]["step_length"]);
    EXPECT_NEAR(own.regularisation, theirs[k]["regularisation"], 1e-12 * own.regularisation);
    EXPECT_EQ(own.feasible, theirs[k]["feasible"]);
    EXPECT_NEAR(own.gaps, theirs[k]["gaps"], 1e-6 * own.gaps + 1e-11);
  }
  EXPECT_LT(solution.kkt_residual, 1e-6);
  EXPECT_EQ(solution.polishing_iterations, 0u);
  expect_close(solution.xs, golden["xs"], "xs");
  expect_close(solution.us, golden["us"], "us");
}

INSTANTIATE_TEST_SUITE_P(Of, Crocoddyl, testing::ValuesIn(names()), [](const auto& info) { return info.param; });

}  // namespace
}  // namespace manycontact
