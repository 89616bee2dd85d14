// A task on copied robots is the task of one of them, as often as there are copies.

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "manycontact/task/optimize.hpp"
#include "support/folder.hpp"
#include "task/task_of.hpp"

namespace manycontact::test {
namespace {

void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

// herd_trots.xml with `copies`, arranged so.
TaskFile herd(int copies, const std::string& arrange) {
  std::ostringstream task, scene;
  task << std::ifstream(kTasks + "herd_trots.xml").rdbuf();
  scene << std::ifstream(kTasks + "herd_scene.xml").rdbuf();
  std::string task_text = task.str(), scene_text = scene.str();
  replace(scene_text, "copies=\"64\" arrange=\"grid\"",
          "copies=\"" + std::to_string(copies) + "\" arrange=\"" + arrange + "\"");
  replace(scene_text, "../quadruped.urdf", kTasks + "../quadruped.urdf");
  const test::TemporaryFolder folder;
  (void)folder.write("herd_scene.xml", scene_text);
  return read_task(folder.write("herd_trots.xml", task_text));
}

TEST(Copies, TrotAsOneDoes) {
  TaskFile one = read_task(kTasks + "quadruped_trots.xml");
  TaskProblem alone = make_problem(one, TaskSolver::kFddp);
  const TaskSolution a = optimize(one, alone, {TaskSolver::kFddp, 1, {}});
  TaskFile three = herd(3, "line");
  TaskProblem together = make_problem(three, TaskSolver::kFddp);
  const TaskSolution b = optimize(three, together, {TaskSolver::kFddp, 1, {}});
  EXPECT_TRUE(a.converged && b.converged) << a.reason << ", " << b.reason;
  EXPECT_NEAR(b.cost, 3 * a.cost, 1e-6 * b.cost);
  const Scene& scene = three.scene.scene;
  for (const Robot& robot : scene.robots) {
    double worst = 0;
    for (std::size_t t = 0; t < a.us.size(); ++t)
      if (a.us[t].size() > 0)  // not at impacts
        worst = std::max(worst, (b.us[t].segment(robot.idx_u, 12) - a.us[t]).lpNorm<Eigen::Infinity>());
    EXPECT_LE(worst, 1e-4) << robot.name;
  }
}

// In a ring the copies are turned: at the guess, costs of all copies are the same but for the facets of cones, which
// stay along the world's axes and cost nothing there.
TEST(Copies, OfARingCostTheSame) {
  TaskFile one = read_task(kTasks + "quadruped_trots.xml");
  TaskProblem alone = make_problem(one, TaskSolver::kFddp);
  TaskFile five = herd(5, "circle");
  TaskProblem together = make_problem(five, TaskSolver::kFddp);
  const double cost = alone.problem->calc(alone.xs, alone.us);
  EXPECT_NEAR(together.problem->calc(together.xs, together.us), 5 * cost, 1e-9 * cost);
}

}  // namespace
}  // namespace manycontact::test
