// Random tasks of robots attached to each other have contacts of every number of rows, damped and not, and weights of
// any size. By blocks the optimum is that of the whole scene, or none is reported.

#include <gtest/gtest.h>

#include <iomanip>
#include <random>
#include <sstream>

#include "manycontact/task/optimize.hpp"
#include "spatial/compare.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "task/task_of.hpp"

namespace manycontact::test {
namespace {

std::string text(double number) {
  std::ostringstream out;
  out << std::setprecision(17) << number;
  return out.str();
}

struct RandomJoined {
  std::string what;
  TaskFile task;
};

// Returns quadrupeds in a line on three of their feet, each with the fourth on the trunk of the next in later nodes.
RandomJoined draw(int seed) {
  std::mt19937 rng(static_cast<unsigned>(4000 + seed));
  const auto pick = [&](const std::vector<std::string>& of) {
    return of[std::uniform_int_distribution<std::size_t>(0, of.size() - 1)(rng)];
  };
  const std::string type = std::vector<std::string>{"1d", "2d", "3d", "5d", "6d"}[static_cast<std::size_t>(seed % 5)];
  const std::string frame = type == "5d" ? "local" : pick({"local", "world", "local_world_aligned"});
  const std::string damping = seed % 3 == 0 ? "1e-3" : "0";
  const double scale = std::pow(10.0, std::uniform_int_distribution<int>(-6, 6)(rng));
  const auto weight = [&](double most) { return " weight='" + text(uniform(rng, 0.1, 1) * most * scale) + "'"; };
  const auto angle = [&](double about) { return "' q='" + text(about + uniform(rng, -0.1, 0.1)) + "'/>"; };
  std::string scene = "<scene name='line' damping='" + damping +
                      "'><robot name='q' urdf='" MANYCONTACT_SOURCE_DIR
                      "/models/quadruped.urdf' base='floating' xyz='0 0 0.3824' copies='" +
                      std::to_string(2 + seed % 2) + "' arrange='line' spacing='1'>";
  for (const char* leg : {"LF", "RF", "LH", "RH"})
    scene += std::string("<joint name='") + leg + "_hip" + angle(0.7) + "<joint name='" + leg + "_knee" + angle(-1.4);
  scene += "</robot>";
  for (const char* leg : {"RF", "LH", "RH"})
    scene += std::string("<contact name='") + leg + "' type='3d' frame='q/" + leg + "_foot' gains='0 20'/>";
  scene += "<contact name='hold' type='" + type + "' frame='q/LF_foot' to='q+1/trunk' gains='40 15' reference_frame='" +
           frame + "'/></scene>";
  const std::string costs = "<cost name='state' type='state' robot='q'" + weight(1) + " weights='" +
                            repeated("0.1", 6) + repeated("0.5", 12) + repeated("0.2", 18) +
                            "'/><cost name='control' type='control'" + weight(1e-3) +
                            "/><cost name='com' type='com' robot='q'" + weight(10) + " reference='" +
                            text(uniform(rng, -0.03, 0.03)) + " " + text(uniform(rng, -0.03, 0.03)) + " 0.36'/>";
  RandomJoined out;
  out.what = type + ", " + frame + ", damping " + damping + ", weights " + std::to_string(std::log10(scale));
  out.task =
      task_of("joined" + std::to_string(seed), scene,
              "<phase nodes='2' contacts='RF LH RH'>" + costs + "</phase><phase nodes='3' contacts='RF LH RH hold'>" +
                  costs + "</phase><terminal><cost name='state' type='state' robot='q'" + weight(10) + "/></terminal>");
  return out;
}

TEST(RandomJoined, OptimaAreThoseOfTheWholeScene) {
  int by_blocks = 0;
  for (int seed = 0; seed < 60; ++seed) {
    const RandomJoined drawn = draw(seed);
    SCOPED_TRACE(std::to_string(seed) + ": " + drawn.what);
    TaskProblem whole = make_problem(drawn.task, TaskSolver::kFddp),
                joined = make_problem(drawn.task, TaskSolver::kSparse);
    by_blocks += joined.blocks.size() > 1 ? 1 : 0;
    const TaskSolution dense = optimize(drawn.task, whole, {TaskSolver::kFddp, 1, {}});
    const TaskSolution ours = optimize(drawn.task, joined, {TaskSolver::kSparse, 1, {}});
    EXPECT_TRUE(dense.converged) << dense.reason;
    EXPECT_TRUE(ours.converged) << ours.reason;
    EXPECT_NEAR(ours.cost, dense.cost, 1e-9 * dense.cost);
    EXPECT_GT(dense.cost, 0);
  }
  EXPECT_EQ(by_blocks, 60);
}

}  // namespace
}  // namespace manycontact::test
