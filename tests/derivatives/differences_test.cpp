// Whole matrices of derivatives agree with differences of the truth, with every method in every order, for all scenes
// whose islands have at most 60 coordinates. Larger ones: directions_test.cpp; redundant contacts: dependent_test.cpp.

#include <map>

#include "derivatives/judge.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

constexpr int kLargest = 60;
#ifdef NDEBUG
constexpr int kSeeds = 16;
#else
constexpr int kSeeds = 8;  // quadruple precision is slow when not optimised
#endif

class DifferencesOf : public testing::TestWithParam<std::string> {};

TEST_P(DifferencesOf, AllMatricesByEveryMethod) {
  SceneFile file = load_small(GetParam());
  if (largest_island(file.scene) > kLargest) GTEST_SKIP() << "too large: see directions_test.cpp";
  for (const char* state : {"as given", "moving"}) {
    const State s{file.q, file.v, file.u};
    const Status status = status_at(file.scene, s);
    EXPECT_NE(status, Status::kFailed);
    expect_differences(scene_name(GetParam()) + " " + state, file.scene, s, status);
    std::mt19937 rng(11);
    disturb(file, rng);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, DifferencesOf, testing::ValuesIn(model_scenes()), scene_title);
INSTANTIATE_TEST_SUITE_P(Golden, DifferencesOf, testing::ValuesIn(golden_scenes()), scene_title);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(DifferencesOf);

// ---- random scenes ----------------------------------------------------------------------------------------------

// Counts how often each feature occurs.
struct Coverage {
  std::map<std::string, int> seen;

  void count(const RandomScene& s) {
    const char* const types[] = {"1D", "2D", "3D", "5D", "6D"};
    const char* const frames[] = {"local", "world", "local_world_aligned"};
    const auto is = [&](const std::string& what, bool yes) { seen[what] += yes; };
    is("damped", s.scene.damping > 0);
    for (const Robot& robot : s.scene.robots) {
      is("floating base", robot.model->floating_base);
      is("fixed base", !robot.model->floating_base);
      is("armature", size_of(robot.model->armature) > 0);
      for (const Joint& joint : robot.model->joints) {
        is("prismatic", joint.type == JointType::kPrismatic);
        is("planar", joint.type == JointType::kPlanar);
        is("inner floating", joint.type == JointType::kFloating && joint.parent >= 0);
      }
    }
    const Contact* before = nullptr;
    for (const Contact& c : s.scene.contacts) {
      is(std::string(types[static_cast<int>(c.type)]) + " " + frames[static_cast<int>(c.reference_frame)], true);
      is("with gains", c.alpha != 0 && c.beta != 0);
      is("loop", c.A.robot == c.B.robot);
      is("between robots", c.B.robot >= 0 && c.A.robot != c.B.robot);
      is("with an error from the world", c.B.robot < 0 && c.alpha != 0);  // random scenes have errors everywhere
      is("on a fixed base", c.A.joint < 0 || (c.B.robot >= 0 && c.B.joint < 0));
      is("on the same link", before && before->A.robot == c.A.robot && before->A.joint == c.A.joint);
      before = &c;
    }
  }
};

RandomScene scene_of(int seed) {
  std::mt19937 rng(650 + seed);
  SceneOptions options;
  options.nrobots = 1 + seed % 3;
  options.ncontacts = 10;
  options.types = {ContactType::k1D, ContactType::k2D, ContactType::k3D, ContactType::k6D,
                   seed % 3 == 0 ? ContactType::k5D : ContactType::k6D};
  options.damping = seed % 4 == 0 ? 1e-3 : seed % 10 == 1 ? 0.1 : 0;
  options.passive = seed % 3 == 1 ? 0.3 : 0;
  options.friction = seed % 5 == 2 ? 0.5 : 0;
  RandomScene s = random_scene(rng, options);
  if (options.friction > 0) s.v *= 0.02;  // where friction has a slope
  return s;
}

class RandomDifferences : public testing::TestWithParam<int> {};

TEST_P(RandomDifferences, AllMatricesByEveryMethod) {
  const RandomScene s = scene_of(GetParam());
  ASSERT_LE(largest_island(s.scene), kLargest);
  expect_differences("random " + std::to_string(GetParam()), s.scene, {s.q, s.v, s.u}, Status::kOk);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomDifferences, testing::Range(1, kSeeds + 1));

// The random scenes are as varied as intended: 13 features, and each type in each frame, 5D in its only one.
TEST(RandomScenes, LeaveNothingOut) {
  Coverage coverage;
  for (int seed = 1; seed <= 24; ++seed) coverage.count(scene_of(seed));
  EXPECT_EQ(coverage.seen.size(), 13u + 13u);
  for (const auto& [what, times] : coverage.seen) EXPECT_GE(times, 3) << what;
}

}  // namespace
}  // namespace manycontact::test
