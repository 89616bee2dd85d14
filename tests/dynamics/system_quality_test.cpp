// system_quality assesses the equations at the current solution, whatever method computed it.

#include <gtest/gtest.h>

#include "manycontact/dynamics/solve.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

constexpr double kRounding = 1e-13;

SceneFile moving(const char* name) {
  SceneFile file = load_small(kModels + name + ".xml");
  std::mt19937 rng(4);
  disturb(file, rng);
  return file;
}

TEST(SystemQuality, IsThatOfEveryMethodsAnswer) {
  for (const char* name : {"herd", "humanoid_standing", "humanoid_hands_and_feet", "quadruped_loop"}) {
    const SceneFile file = moving(name);
    for (const Way& way : ways_here(true)) {
      SCOPED_TRACE(std::string(name) + " by " + way.name);
      SceneData data(file.scene, way.options);
      const Report& report = solve(file.scene, file.q, file.v, file.u, data);
      estimate_condition(file.scene, data);
      const std::vector<SystemQuality> all = system_quality(file.scene, data);
      ASSERT_EQ(all.size(), report.islands.size());
      for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_LE(all[i].componentwise_backward_error, kRounding);
        EXPECT_LE(all[i].normwise_backward_error, all[i].componentwise_backward_error + 1e-16);
        EXPECT_GE(all[i].growth, 1);
        EXPECT_GT(all[i].condition, 1);
        EXPECT_GT(all[i].scaled_condition, 1);
        EXPECT_EQ(all[i].positive, report.islands[i].nv);
        EXPECT_EQ(all[i].zero, data.options.reduce_pairs ? all[i].zero : report.islands[i].nc - report.islands[i].rank);
      }
      data.a *= 1 + 1e-6;
      for (const SystemQuality& of : system_quality(file.scene, data)) {
        EXPECT_GT(of.componentwise_backward_error, 1e-9);
        EXPECT_GT(of.normwise_backward_error, 1e-12);
      }
    }
  }
}

TEST(SystemQuality, SignatureCountsDependentRows) {
  const SceneFile file = moving("feet_on_corners");
  Options options;
  options.reduce_pairs = false;
  SceneData data(file.scene, options);
  const Report& report = solve(file.scene, file.q, file.v, file.u, data);
  ASSERT_LT(report.rank, report.nc);
  const SystemQuality of = system_quality(file.scene, data).front();
  EXPECT_EQ(of.positive, report.nv);
  EXPECT_EQ(of.negative, report.rank);
  EXPECT_EQ(of.zero, report.nc - report.rank);
}

// With grams in place of kilograms the condition depends on the units, the scaled condition on the robot alone.
TEST(SystemQuality, ScaledConditionKnowsNoUnits) {
  SceneFile file = moving("humanoid_hands_and_feet");
  const auto quality = [&] {
    SceneData data(file.scene);
    (void)solve(file.scene, file.q, file.v, file.u, data);
    return system_quality(file.scene, data).front();
  };
  const SystemQuality before = quality();
  for (Robot& robot : file.scene.robots) {
    auto model = std::make_shared<Model>(*robot.model);
    for (Joint& joint : model->joints) joint.inertia.m *= 1e6, joint.inertia.h *= 1e6, joint.inertia.I *= 1e6;
    model->armature *= 1e6;
    robot.model = model;
  }
  const SystemQuality after = quality();
  EXPECT_GT(after.condition / before.condition, 1e3);
  EXPECT_LT(after.scaled_condition / before.scaled_condition, 3);
  EXPECT_GT(after.scaled_condition / before.scaled_condition, 1.0 / 3);
}

TEST(SystemQuality, NeedsASolution) {
  const SceneFile file = moving("herd");
  SceneData data(file.scene);
  EXPECT_THROW((void)system_quality(file.scene, data), std::logic_error);
}

}  // namespace
}  // namespace manycontact::test
