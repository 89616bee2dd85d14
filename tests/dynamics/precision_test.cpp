// Options::precision, single: errors agree with the condition, refused islands are reported, bits are the
// same in any SIMD batch, and earlier solves do not affect a solution.

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "manycontact/dynamics/batch.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/allocations.hpp"
#include "support/piles.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

constexpr double kFloat = 1.2e-7;  // eps

Options in_precision(Precision precision, SimdLevel lanes = SimdLevel::kAuto) {
  Options options;
  options.simd_level = lanes;
  options.precision = precision;
  return options;
}

// Returns robots of one random model in their own states, each constrained to the world in the same way.
RandomScene random_robots(std::mt19937& rng, int count, bool floating, double damping = 0) {
  RandomScene s;
  ModelOptions options;
  options.njoints = 12;
  options.branching = 0.1;
  options.floating_base = floating;
  const auto model = std::make_shared<const Model>(random_model(rng, options));
  s.scene.damping = damping;
  for (int r = 0; r < count; ++r) add_robot(s.scene, "r" + std::to_string(r), model, random_placement(rng));
  for (int k = 0; k < 2; ++k) {
    Contact c;
    c.type = k == 0 ? ContactType::k6D : ContactType::k3D;
    c.reference_frame = static_cast<ReferenceFrame>(k);
    c.alpha = 20, c.beta = 7;
    const SE3<double> on_body = random_placement(rng);
    for (int r = 0; r < count; ++r) {
      c.name = "c" + std::to_string(r) + "_" + std::to_string(k);
      c.A = {r, k == 0 ? 11 : 7, on_body};
      c.B.placement = random_placement(rng);
      add_contact(s.scene, c);
    }
  }
  s.q.resize(s.scene.nq);
  for (const Robot& r : s.scene.robots) s.q.segment(r.idx_q, model->nq) = random_configuration(*model, rng);
  s.v = random_vector(s.scene.nv, rng);
  s.u = random_vector(s.scene.nu, rng, 5);
  return s;
}

int count_of(const Report& report, Precision precision) {
  int count = 0;
  for (const IslandReport& island : report.islands) count += island.precision == precision;
  return count;
}

// Expects that each island that was not solved in the requested precision reports this.
void expect_told(const Report& report, Precision asked) {
  for (const IslandReport& island : report.islands) {
    if (island.status == Status::kFailed) continue;
    EXPECT_TRUE(island.precision == asked || island.precision == Precision::kDouble);
    if (island.precision == asked) {
      EXPECT_NE(island.reason, Reason::kLowPrecision);
    } else {
      EXPECT_NE(island.reason, Reason::kNone);
    }
  }
}

double largest_difference(const VectorXd& x, const VectorXd& y) {
  return x.size() == 0 ? 0 : (x - y).cwiseAbs().maxCoeff() / std::max(1e-300, y.cwiseAbs().maxCoeff());
}

// Robots that contacts join are solved in double, and the report tells it.
TEST(Precision, JoinedRobotsAreSolvedInDouble) {
  for (const bool points : {true, false})
    for (int boxes = 2; boxes <= 12; ++boxes) {
      PileMaker make;
      for (int k = 0; k < boxes; ++k) {
        make.box(0, 0, k);
        make.join(points ? ContactType::k3D : ContactType::k6D, k, k - 1, {0.1, 0.02 * k, k - 0.5});
      }
      const RandomScene s = make.finish();
      SceneData exact(s.scene), data(s.scene, in_precision(Precision::kSingle));
      for (SceneData* each : {&exact, &data}) (void)solve(s.scene, s.q, s.v, s.u, *each);
      expect_told(data.report, Precision::kSingle);
      EXPECT_EQ(count_of(data.report, Precision::kDouble), 1) << boxes;
      EXPECT_EQ(data.a, exact.a) << boxes;
      EXPECT_EQ(data.f, exact.f) << boxes;
    }
}

TEST(Precision, SingleErrsAsTheConditionPredicts) {
  std::mt19937 rng(3);
  int single = 0, all = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const RandomScene s = random_robots(rng, 1 + (5 * trial) % 23, trial % 2 == 0, trial % 3 == 0 ? 1e-3 : 0);
    SceneData exact(s.scene), data(s.scene, in_precision(Precision::kSingle));
    (void)solve(s.scene, s.q, s.v, s.u, exact);
    (void)solve(s.scene, s.q, s.v, s.u, data);
    expect_told(data.report, Precision::kSingle);
    estimate_condition(s.scene, exact);
    for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
      const IslandReport& report = data.report.islands[i];
      ++all, single += report.precision == Precision::kSingle;
      if (report.precision != Precision::kSingle) continue;
      const Robot& robot = s.scene.robots[solved_island(data, i).robots.front()];
      const auto at = Eigen::seqN(robot.idx_v, robot.model->nv);
      EXPECT_LE(largest_difference(data.a(at), exact.a(at)),
                std::min(1e-2, 100 * kFloat * exact.report.islands[i].condition));
    }
  }
  EXPECT_GT(single, all / 2);
  std::cout << single << " of " << all << " robots in single precision\n";
}

TEST(Precision, SingleHasTheSameBitsAloneAndInABatch) {
  std::mt19937 rng(5);
  for (const SimdLevel lanes : available_simd_levels()) {
    const RandomScene s = random_robots(rng, 37, true);
    SceneData together(s.scene, in_precision(Precision::kSingle, lanes));
    (void)solve(s.scene, s.q, s.v, s.u, together);
    ASSERT_GT(count_of(together.report, Precision::kSingle), 0);
    for (int r : {0, 7, 20, 36}) {
      Scene alone;
      const Robot& robot = s.scene.robots[r];
      add_robot(alone, "r", robot.model, robot.base);
      for (Contact c : s.scene.contacts)
        if (c.A.robot == r) c.A.robot = 0, add_contact(alone, c);
      SceneData data(alone, in_precision(Precision::kSingle, lanes));
      (void)solve(alone, s.q.segment(robot.idx_q, robot.model->nq), s.v.segment(robot.idx_v, robot.model->nv),
                  s.u.segment(robot.idx_u, robot.model->nu()), data);
      EXPECT_EQ(data.a, together.a.segment(robot.idx_v, robot.model->nv)) << "robot " << r << " " << to_string(lanes);
    }
  }
}

// A robot is constrained twice, at points 1e-4 m apart: the rows are independent in double, but not in float.
TEST(Precision, SingleIsRefusedAndToldWhereTheConditionIsPoor) {
  std::mt19937 rng(7);
  RandomScene s = random_robots(rng, 5, true);
  Contact twice;
  for (const Contact& c : s.scene.contacts)
    if (c.A.robot == 2 && c.type == ContactType::k3D) twice = c;
  twice.name = "twice";
  twice.type = ContactType::k1D;
  twice.axis = {0, 0, 1};
  twice.A.placement.p.x() += 1e-4;
  add_contact(s.scene, twice);
  Options options = in_precision(Precision::kSingle), plain;
  options.reduce_pairs = plain.reduce_pairs = false;
  SceneData exact(s.scene, plain), data(s.scene, options);
  ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, exact).status, Status::kOk);
  (void)solve(s.scene, s.q, s.v, s.u, data);
  expect_told(data.report, Precision::kSingle);
  EXPECT_EQ(data.report.islands[0].precision, Precision::kSingle);
  EXPECT_EQ(data.report.islands[2].precision, Precision::kDouble);
  EXPECT_EQ(data.report.islands[2].reason, Reason::kLowPrecision);
  const Robot& robot = s.scene.robots[2];
  EXPECT_EQ(data.a.segment(robot.idx_v, robot.model->nv), exact.a.segment(robot.idx_v, robot.model->nv));
}

// Contacts with gains are 1e7 m away from the world's origin, and joints are wound up by 1e4 revolutions.
TEST(Precision, SingleLosesNothingFarAwayAndWoundUp) {
  std::mt19937 rng(11);
  RandomScene s = random_robots(rng, 9, true);
  SceneData near(s.scene, in_precision(Precision::kSingle));
  (void)solve(s.scene, s.q, s.v, s.u, near);
  const Vec3<double> by(16777216, -8388608, 4194304);
  for (const Robot& robot : s.scene.robots) {
    s.q.segment<3>(robot.idx_q) += by;
    for (const Joint& joint : robot.model->joints)
      if (joint.type == JointType::kRevolute) s.q[robot.idx_q + joint.idx_q] += 2 * std::acos(-1.0) * 1e4;
  }
  for (Contact& c : s.scene.contacts) c.B.placement.p += by;
  SceneData exact(s.scene), far(s.scene, in_precision(Precision::kSingle));
  (void)solve(s.scene, s.q, s.v, s.u, exact);
  (void)solve(s.scene, s.q, s.v, s.u, far);
  EXPECT_EQ(count_of(far.report, Precision::kSingle), count_of(near.report, Precision::kSingle));
  EXPECT_GT(count_of(far.report, Precision::kSingle), 4);
  EXPECT_LE(largest_difference(far.a, exact.a), 1e-3);
}

// Bodies spin so fast that the terms of h bury everything else in floats, though h itself may vanish.
TEST(Precision, SingleIsWorthTwoDigitsAtAnySpeed) {
  std::mt19937 rng(13);
  for (const double speed : {1e1, 1e2, 1e3, 1e4, 1e5}) {
    RandomScene s = random_robots(rng, 8, true);
    s.v *= speed;
    SceneData exact(s.scene), data(s.scene, in_precision(Precision::kSingle));
    (void)solve(s.scene, s.q, s.v, s.u, exact);
    (void)solve(s.scene, s.q, s.v, s.u, data);
    expect_told(data.report, Precision::kSingle);
    for (const Robot& robot : s.scene.robots) {
      const auto at = Eigen::seqN(robot.idx_v, robot.model->nv);
      EXPECT_LE(largest_difference(data.a(at), exact.a(at)), 1e-2) << speed;
    }
  }
}

// A wheel on an arm is balanced: its terms are the speed squared times the arm's length, and all of them cancel.
TEST(Precision, SingleKnowsThatTheTermsOfASpinCancel) {
  auto model = std::make_shared<Model>();
  Joint arm, wheel;
  arm.name = "arm", arm.axis = {0, 1, 0};
  arm.inertia = Inertia<double>::from_com(1, {0.3, 0, 0}, 0.1 * Mat3<double>::Identity());
  wheel.name = "wheel", wheel.parent = 0, wheel.axis = {0, 0, 1};
  wheel.placement.p = {1, 0.2, 0.1};
  wheel.inertia = Inertia<double>::from_com(2, {0, 0, 0}, Vec3<double>(0.1, 0.1, 0.2).asDiagonal());
  model->joints = {arm, wheel};
  finalize(*model);
  Scene scene;
  add_robot(scene, "r", model, SE3<double>());
  VectorXd q(2), v(2), u = VectorXd::Zero(scene.nu);
  q << 0.3, 0.7;
  for (const double speed : {1.0, 1e5}) {
    v << 0.2, speed;
    SceneData exact(scene), data(scene, in_precision(Precision::kSingle));
    (void)solve(scene, q, v, u, exact);
    (void)solve(scene, q, v, u, data);
    expect_told(data.report, Precision::kSingle);
    EXPECT_EQ(data.report.islands[0].precision, speed == 1 ? Precision::kSingle : Precision::kDouble);
    EXPECT_LE(std::abs(data.a[0] - exact.a[0]), 1e-2 * std::abs(exact.a[0])) << speed;
  }
}

class EveryPrecision : public testing::TestWithParam<Precision> {};

TEST_P(EveryPrecision, IsToldInEveryScene) {
  for (const std::string& path : model_scenes()) {
    SCOPED_TRACE(path);
    SceneFile file = load_small(path);
    std::mt19937 rng(17);
    disturb(file, rng);
    SceneData exact(file.scene), data(file.scene, in_precision(GetParam()));
    (void)solve(file.scene, file.q, file.v, file.u, exact);
    (void)solve(file.scene, file.q, file.v, file.u, data);
    expect_told(data.report, GetParam());
    EXPECT_EQ(data.report.status, exact.report.status);
    EXPECT_LE(largest_difference(data.a, exact.a), GetParam() == Precision::kSingle ? 1e-2 : 1e-9);
  }
}

TEST_P(EveryPrecision, TheStateAloneDecides) {
  std::mt19937 rng(19);
  RandomScene s = random_robots(rng, 21, true);
  Options options = in_precision(GetParam());
  SceneData data(s.scene, options), other(s.scene, options);
  options.threads = 3;
  SceneData threads(s.scene, options);
  (void)solve(s.scene, s.q, s.v, s.u, data);
  const VectorXd a = data.a, f = data.f;
  (void)solve(s.scene, s.q, random_vector(s.scene.nv, rng, 1e4), s.u, other);
  (void)solve(s.scene, s.q, s.v, s.u, other);
  EXPECT_EQ(other.a, a);
  EXPECT_EQ(other.f, f);
  (void)solve(s.scene, s.q, s.v, s.u, threads);
  EXPECT_EQ(threads.a, a);
  EXPECT_EQ(threads.f, f);
}

TEST_P(EveryPrecision, AllocatesNothingAfterTheFirstSolve) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  std::mt19937 rng(23);
  const RandomScene s = random_robots(rng, 19, true);
  SceneData data(s.scene, in_precision(GetParam()));
  (void)solve(s.scene, s.q, s.v, s.u, data);
  (void)differentiate(s.scene, data);
  const VectorXd v = random_vector(s.scene.nv, rng);
  EXPECT_EQ(allocations([&] {
              (void)solve(s.scene, s.q, v, s.u, data);
              (void)differentiate(s.scene, data);
            }),
            0u);
}

// Derivatives are those of the double solution, up to the differences of accelerations and forces.
TEST_P(EveryPrecision, DerivativesAreThoseAtTheSolution) {
  std::mt19937 rng(29);
  const RandomScene s = random_robots(rng, 18, true);
  SceneData exact(s.scene), data(s.scene, in_precision(GetParam()));
  (void)solve(s.scene, s.q, s.v, s.u, exact);
  (void)solve(s.scene, s.q, s.v, s.u, data);
  const DerivativeData& right = differentiate(s.scene, exact);
  const DerivativeData& mine = differentiate(s.scene, data);
  const VectorXd dq = random_vector(s.scene.nv, rng), dv = random_vector(s.scene.nv, rng),
                 du = random_vector(s.scene.nu, rng);
  VectorXd da(s.scene.nv), df(data.f.size()), right_a = da, right_f = df;
  jvp(s.scene, exact, dq, dv, du, right_a, right_f);
  jvp(s.scene, data, dq, dv, du, da, df);
  const double all = GetParam() == Precision::kSingle ? 1e-2 : 1e-9;
  EXPECT_LE(largest_difference(da, right_a), all);
  EXPECT_LE(largest_difference(df, right_f), all);
  for (std::size_t i = 0; i < right.islands.size(); ++i)
    EXPECT_LE((mine.islands[i].X - right.islands[i].X).cwiseAbs().maxCoeff(),
              all * right.islands[i].X.cwiseAbs().maxCoeff());
}

TEST_P(EveryPrecision, BatchesHaveTheBitsOfASolve) {
  std::mt19937 rng(31);
  const RandomScene s = random_robots(rng, 1, true);
  constexpr int kStates = 21;
  BatchMatrix q(kStates, s.scene.nq), v(kStates, s.scene.nv), u(kStates, s.scene.nu);
  for (int k = 0; k < kStates; ++k) {
    q.row(k) = s.q.transpose();
    v.row(k) = random_vector(s.scene.nv, rng).transpose();
    u.row(k) = random_vector(s.scene.nu, rng).transpose();
  }
  BatchData batch(s.scene, 2, in_precision(GetParam()));
  BatchMatrix A(kStates, s.scene.nv), F(kStates, force_rows(s.scene, batch));
  std::vector<Status> status(kStates);
  solve_batch(s.scene, {q, v, u}, batch, A, F, status);
  SceneData data(s.scene, in_precision(GetParam()));
  for (int k = 0; k < kStates; ++k) {
    (void)solve(s.scene, q.row(k).transpose(), v.row(k).transpose(), u.row(k).transpose(), data);
    EXPECT_EQ(VectorXd(A.row(k)), data.a) << k;
    EXPECT_EQ(VectorXd(F.row(k)), data.f) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, EveryPrecision, testing::Values(Precision::kSingle),
                         [](const auto& info) { return to_string(info.param); });

}  // namespace
}  // namespace manycontact::test
