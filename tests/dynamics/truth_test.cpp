// True errors are those against the forward path in quadruple precision.

#include "support/truth.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "support/measure.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

Truth<Quad> true_answer(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                        const Eigen::VectorXd& u) {
  std::vector<char> active;
  for (const Contact& contact : scene.contacts) active.push_back(contact.active);
  return solve_truth<Quad>(scene, active, q.cast<Quad>(), v.cast<Quad>(), u.cast<Quad>());
}

int rank_sum(const Truth<Quad>& truth) {
  int rank = 0;
  for (int r : truth.rank) rank += r;
  return rank;
}

void print_row(const std::string& scene, const std::string& way, double condition, const Errors& e) {
  std::printf("%-38s %-18s %9.1e %9.1e %9.1e %9.1e\n", scene.c_str(), way.c_str(), condition, e.acceleration, e.forces,
              e.excess);
}

// Compares the errors of every method at a state with the allowed ones.
void expect_true(const std::string& name, const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                 const Eigen::VectorXd& u, bool equilibrium) {
  const Truth<Quad> truth = true_answer(scene, q, v, u);
  SceneData oracle(scene, {Method::kDense, {}});
  const Status status = solve(scene, q, v, u, oracle).status;
  ASSERT_NE(status, Status::kFailed) << name;
  const std::vector<double> condition = conditions(scene, oracle);
  // with damping K is regular whatever the rank of J, which the truth reports
  EXPECT_EQ(oracle.report.rank, scene.damping > 0 ? oracle.report.nc : rank_sum(truth)) << name;
  const Eigen::VectorXd a_free = equilibrium ? free_accelerations(scene, q, v, u) : Eigen::VectorXd();
  for (const Way& way : ways(true)) {
    if (way.options.method == Method::kDenseSchur && status != Status::kOk) continue;
    SCOPED_TRACE(name + ", " + way.name);
    SceneData data(scene, way.options);
    EXPECT_EQ(solve(scene, q, v, u, data).status, status);
    const Errors e = errors<Quad>(scene, data, truth.a, truth.f, condition, a_free);
    EXPECT_LE(e.excess, 1) << e;
    const bool shown = way.name == "dense" || way.name == "sparse-ldl" || way.name == "dense-schur";
    if (shown) print_row(name, way.name, oracle.report.condition, e);
  }
}

void print_header() {
  std::printf("%-38s %-18s %9s %9s %9s %9s\n", "scene", "method", "condition", "a", "f", "/allowed");
}

class TruthOf : public testing::TestWithParam<std::string> {};

// Copies are reduced to four, so islands have up to 152 coordinates.
TEST_P(TruthOf, EveryMethod) {
  SceneFile file = load_small(GetParam());
  print_header();
  const std::string name = scene_name(GetParam());
  expect_true(name + " at rest", file.scene, file.q, file.v, file.u, true);
  std::mt19937 rng(11);
  disturb(file, rng);
  expect_true(name + " moving", file.scene, file.q, file.v, file.u, false);
}

INSTANTIATE_TEST_SUITE_P(Models, TruthOf, testing::ValuesIn(model_scenes()), scene_title);
INSTANTIATE_TEST_SUITE_P(Golden, TruthOf, testing::ValuesIn(golden_scenes()), scene_title);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(TruthOf);

TEST(Truth, RandomScenes) {
  print_header();
  int loops = 0, joined = 0, gains = 0, of_type[5] = {}, in_frame[3] = {};
  for (int seed = 1; seed <= 12; ++seed) {
    std::mt19937 rng(100 + seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 3;
    options.damping = seed % 4 == 0 ? 1e-3 : 0;
    const RandomScene s = random_scene(rng, options);
    expect_true("random " + std::to_string(seed), s.scene, s.q, s.v, s.u, false);
    for (const Contact& c : s.scene.contacts) {
      loops += c.A.robot == c.B.robot;
      joined += c.B.robot >= 0 && c.A.robot != c.B.robot;
      gains += c.alpha != 0;
      ++of_type[static_cast<int>(c.type)];
      ++in_frame[static_cast<int>(c.reference_frame)];
    }
  }
  // The random scenes are as varied as they are meant to be.
  for (int count : {loops, joined, gains, of_type[0], of_type[1], of_type[2], of_type[3], of_type[4], in_frame[0],
                    in_frame[1], in_frame[2]})
    EXPECT_GE(count, 3);
}

TEST(Truth, RandomScenesWithDependentContacts) {
  print_header();
  for (int seed = 1; seed <= 8; ++seed) {
    std::mt19937 rng(200 + seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 2;
    options.redundant = 2;
    options.contradicting = seed % 2;
    const RandomScene s = random_scene(rng, options);
    expect_true("random dependent " + std::to_string(seed), s.scene, s.q, s.v, s.u, false);
  }
}

// Far from the world's origin nothing is lost: the tree frame is at the robot's base.
TEST(Truth, FarFromTheOrigin) {
  print_header();
  SceneFile file = load_edited(MANYCONTACT_SOURCE_DIR "/models/humanoid_hands_and_feet.xml",
                               {{"xyz=\"0 0 0.7884\"", "xyz=\"1e4 -2e4 0.7884\""}});
  expect_true("10 km away", file.scene, file.q, file.v, file.u, true);
}

// The truth is not the double-precision solution in disguise.
TEST(Truth, HasMoreDigits) {
  std::mt19937 rng(5);
  const RandomScene s = random_scene(rng);
  const Truth<Quad> truth = true_answer(s.scene, s.q, s.v, s.u);
  EXPECT_GT(error_of(truth.a.cast<double>(), truth.a), 0);
  EXPECT_LT(error_of(truth.a.cast<double>(), truth.a), kEps);
  SceneData data(s.scene, {Method::kDense, {}});
  (void)solve(s.scene, s.q, s.v, s.u, data);
  EXPECT_GT(error_of(data.a, truth.a), 0);
}

// Returns the error relative to the largest entry.
Quad far_from(const VecX<Quad>& x, const VecX<Quad>& y) {
  return (x - y).cwiseAbs().maxCoeff() / y.cwiseAbs().maxCoeff();
}

TEST(RefinedTruth, IsTheDenseOne) {
  for (const char* name :
       {"humanoid_hands_and_feet", "feet_on_corners", "quadruped_loop", "two_humanoids_carry_beam"}) {
    SCOPED_TRACE(name);
    SceneFile file = load_scene(std::string(MANYCONTACT_SOURCE_DIR "/models/") + name + ".xml");
    std::mt19937 rng(5);
    disturb(file, rng);
    SceneData data(file.scene, {Method::kSparseLdl, Order::kLeafToRoot});
    (void)solve(file.scene, file.q, file.v, file.u, data);
    Eigen::VectorXd v = file.v;
    v.array() += 1e-9;  // the factor is that of a nearby state
    const VecX<Quad> qq = file.q.cast<Quad>(), vq = v.cast<Quad>(), uq = file.u.cast<Quad>();
    const Truth<Quad> dense = solve_truth<Quad>(file.scene, data.active, qq, vq, uq);
    const Truth<Quad> refined = refine_truth<Quad>(file.scene, data, qq, vq, uq, 150);
    ASSERT_EQ(refined.regular, dense.regular);
    EXPECT_LT(far_from(refined.a, dense.a), 1e-24);
    EXPECT_LT(far_from(refined.f, dense.f), 1e-24);
    EXPECT_EQ(refined.h, dense.h);
  }
}

// Without a factor, and if it is too large for the dense method, the truth is unknown rather than wrong.
TEST(RefinedTruth, OwnsUpToNotKnowing) {
  const SceneFile file = load_scene(MANYCONTACT_SOURCE_DIR "/models/feet_on_corners.xml");
  SceneData data(file.scene, {Method::kSparseLdl, Order::kLeafToRoot});
  (void)solve(file.scene, file.q, file.v, file.u, data);
  const Truth<Quad> truth =
      refine_truth<Quad>(file.scene, data, file.q.cast<Quad>(), file.v.cast<Quad>(), file.u.cast<Quad>(), 61);
  EXPECT_FALSE(truth.regular[0]);
  for (const Quad& a : truth.a) EXPECT_TRUE(a != a);
}

}  // namespace
}  // namespace manycontact::test
