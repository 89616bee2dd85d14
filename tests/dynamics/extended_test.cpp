// The precision `extended` is compared with quadruple precision on scenes of every kind of contact and force. Memory,
// batches, steps and refused input are tested too.

#include <gtest/gtest.h>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/dynamics/batch.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "manycontact/io/urdf.hpp"
#include "manycontact/simulation/step.hpp"
#include "support/allocations.hpp"
#include "support/applied.hpp"
#include "support/measure.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/truth.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

constexpr double kUnits = 4 * std::numeric_limits<double>::epsilon();

Options extended(Options options = {}) {
  options.precision = Precision::kExtended;
  return options;
}

bool all_extended(const Report& report) {
  return std::ranges::all_of(report.islands, [](const auto& i) { return i.precision == Precision::kExtended; });
}

std::vector<char> active(const Scene& scene) {
  std::vector<char> out;
  for (const Contact& contact : scene.contacts) out.push_back(contact.active);
  return out;
}

Truth<Quad> truth_of(const Scene& scene, const VectorXd& q, const VectorXd& v, const VectorXd& u) {
  return solve_truth<Quad>(scene, active(scene), q.cast<Quad>(), v.cast<Quad>(), u.cast<Quad>());
}

// Returns the relative error of the robot with the largest one.
double worst_error(const Scene& scene, const SceneData& data, const VecX<Quad>& a, const VecX<Quad>& f) {
  const std::vector<double> condition(data.report.islands.size(), 1);
  const Errors e = errors<Quad>(scene, data, a, f, condition);
  return std::max(e.acceleration, e.forces);
}

// Every method reports the precision `extended` and attains it.
void expect_extended(const Scene& scene, const VectorXd& q, const VectorXd& v, const VectorXd& u) {
  const Truth<Quad> truth = truth_of(scene, q, v, u);
  for (const Way& way : ways_here(true)) {
    SCOPED_TRACE(way.name);
    SceneData plain(scene, way.options), data(scene, extended(way.options));
    (void)solve(scene, q, v, u, plain);
    (void)solve(scene, q, v, u, data);
    if (plain.report.status == Status::kFailed) continue;
    EXPECT_EQ(data.report.status, plain.report.status);
    EXPECT_TRUE(all_extended(data.report)) << to_string(data.report.islands[0].reason);
    EXPECT_LE(worst_error(scene, data, truth.a, truth.f), kUnits)
        << "in double " << worst_error(scene, plain, truth.a, truth.f);
    estimate_errors(scene, data);
    EXPECT_EQ(data.report.status, plain.report.status);
    EXPECT_GT(data.report.error_acceleration, 0);
    EXPECT_LT(data.report.error_acceleration, 1e-13);
  }
}

// A robot that cannot move has no joints.
TEST(ExtendedPrecision, RobotsWithoutJoints) {
  Scene scene;
  for (bool floating : {false, true})
    add_robot(scene, floating ? "free" : "fixed",
              std::make_shared<const Model>(load_urdf(kModels + "box.urdf", {.floating_base = floating})));
  ASSERT_TRUE(scene.robots[0].model->joints.empty());
  expect_extended(scene, neutral(scene), VectorXd::Zero(scene.nv), VectorXd::Zero(scene.nu));
}

TEST(ExtendedPrecision, RandomScenes) {
  for (int seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 rng(seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 3;
    options.ncontacts = 1 + seed % 4;
    options.damping = seed % 2 ? 1e-6 : 0;
    RandomScene s = random_scene(rng, options);
    if (seed > 2) add_random_forces(s.scene, rng);
    expect_extended(s.scene, s.q, s.v, s.u);
  }
}

TEST(ExtendedPrecision, ModelScenes) {
  for (const char* name : {"herd", "humanoid_standing", "humanoid_hands_and_feet", "quadruped_loop", "humanoid_pushed",
                           "feet_on_corners"}) {
    SCOPED_TRACE(name);
    SceneFile file = load_small(kModels + name + ".xml");
    std::mt19937 rng(3);
    disturb(file, rng);
    for (const bool damped : {false, true}) {
      file.scene.damping = damped ? 1e-7 : 0;
      const Truth<Quad> truth = truth_of(file.scene, file.q, file.v, file.u);
      for (const bool reduced : {true, false}) {
        Options options = extended();
        options.reduce_pairs = reduced;
        SceneData data(file.scene, options);
        const Report& report = solve(file.scene, file.q, file.v, file.u, data);
        if (report.status >= Status::kInconsistent) continue;
        EXPECT_TRUE(all_extended(report)) << to_string(report.islands[0].reason) << " reduced " << reduced;
        EXPECT_LE(worst_error(file.scene, data, truth.a, truth.f), kUnits) << "damped " << damped << ", " << reduced;
      }
    }
  }
}

TEST(ExtendedPrecision, PrescribedAccelerations) {
  std::mt19937 rng(5);
  const RandomScene s = random_scene(rng, {});
  SceneData plain(s.scene), data(s.scene, extended());
  prepare(s.scene, data);
  const VectorXd wanted = random_vector(static_cast<int>(data.f.size()), rng, 3), tau = random_vector(s.scene.nv, rng);
  (void)solve_tau(s.scene, s.q, s.v, tau, wanted, plain);
  EXPECT_TRUE(all_extended(solve_tau(s.scene, s.q, s.v, tau, wanted, data)));
  EXPECT_LE((data.a - plain.a).cwiseAbs().maxCoeff(), 1e-9 * plain.a.cwiseAbs().maxCoeff());
}

// Inconsistent contacts leave a residual far above rounding error; it is least squares to the last digits.
TEST(ExtendedPrecision, LeastSquaresWhereContactsContradict) {
  for (const double fast : {1.0, 1e4}) {
    SceneFile file = load_text(
        "<scene><robot name='b' urdf=\"box.urdf\" base='floating'/>"
        "<contact name='x' type='3d' frame='b/crate' offset='0.1 0 0'/>"
        "<contact name='y' type='3d' frame='b/crate' offset='0.2 0 0'/></scene>");
    std::mt19937 rng(2);
    disturb(file, rng);
    file.v *= fast;
    ASSERT_EQ(truth_of(file.scene, file.q, file.v, file.u).a.size(), file.scene.nv);
    SceneData plain(file.scene);
    ASSERT_EQ(solve(file.scene, file.q, file.v, file.u, plain).status, Status::kInconsistent);
    expect_extended(file.scene, file.q, file.v, file.u);
  }
}

TEST(ExtendedPrecision, AllocatesNothing) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  for (const char* name : {"herd", "humanoid_standing", "quadruped_loop", "humanoid_pushed", "feet_on_corners"}) {
    SCOPED_TRACE(name);
    SceneFile file = load_small(kModels + name + ".xml");
    std::mt19937 rng(3);
    disturb(file, rng);
    SceneData data(file.scene, extended());
    for (int again = 0; again < 2; ++again) (void)solve(file.scene, file.q, file.v, file.u, data);
    for (int again = 0; again < 3; ++again) {
      disturb(file, rng);
      EXPECT_EQ(allocations([&] { (void)solve(file.scene, file.q, file.v, file.u, data); }), 0u);
    }
  }
}

// The bits are the same in a batch, one by one, and after other states.
TEST(ExtendedPrecision, BatchesAreAsSolves) {
  SceneFile file = load_scene(kModels + "humanoid_standing.xml");
  const Scene& scene = file.scene;
  constexpr int kStates = 9;
  BatchMatrix q(kStates, scene.nq), v(kStates, scene.nv), u(kStates, scene.nu);
  std::mt19937 rng(7);
  for (int k = 0; k < kStates; ++k) {
    disturb(file, rng);
    q.row(k) = file.q.transpose(), v.row(k) = file.v.transpose(), u.row(k) = file.u.transpose();
  }
  BatchData batch(scene, 1, extended());
  BatchMatrix a(kStates, scene.nv), f(kStates, force_rows(scene, batch));
  std::vector<Status> status(kStates);
  solve_batch(scene, {q, v, u}, batch, a, f, status);
  SceneData data(scene, extended());
  for (int k = 0; k < kStates; ++k) {
    EXPECT_TRUE(all_extended(solve(scene, q.row(k).transpose(), v.row(k).transpose(), u.row(k).transpose(), data)));
    EXPECT_EQ(a.row(k).transpose(), data.a);
    EXPECT_EQ(f.row(k).transpose(), data.f);
  }
}

// Derivatives are those at the solution, as in double precision.
TEST(ExtendedPrecision, HasDerivatives) {
  SceneFile file = load_scene(kModels + "quadruped_loop.xml");
  std::mt19937 rng(7);
  disturb(file, rng);
  SceneData plain(file.scene), data(file.scene, extended());
  (void)solve(file.scene, file.q, file.v, file.u, plain);
  ASSERT_TRUE(all_extended(solve(file.scene, file.q, file.v, file.u, data)));
  (void)differentiate(file.scene, plain), (void)differentiate(file.scene, data);
  const auto &x = derivatives(plain).islands[0].X, &y = derivatives(data).islands[0].X;
  EXPECT_LE((x - y).cwiseAbs().maxCoeff(), 1e-9 * x.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace manycontact::test
