// An estimate that was not computed is reported as NaN, never as a perfect 0; solves are timed.

#include "manycontact/dynamics/report.hpp"

#include <algorithm>
#include <cmath>

#include "manycontact/dynamics/differentiate.hpp"
#include "support/methods.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

void expect_no_estimates(const Report& report) {
  EXPECT_TRUE(std::isnan(report.condition));
  EXPECT_TRUE(std::isnan(report.error_acceleration));
  EXPECT_TRUE(std::isnan(report.error_forces));
  for (const IslandReport& island : report.islands)
    for (const double x : {island.condition, island.error_acceleration, island.error_forces})
      EXPECT_TRUE(std::isnan(x));
}

// Some have several contacts between two bodies, whose rows are reduced (Options::reduce_pairs).
constexpr const char* kScenes[] = {"humanoid_standing.xml", "two_humanoids_carry_beam.xml", "feet_on_corners.xml"};

TEST(Report, HasNoEstimatesThatWereNotAskedFor) {
  expect_no_estimates(Report{});
  for (const char* name : kScenes) {
    const SceneFile file = load_scene(kModels + name);
    for (const Method method : methods()) {
      SceneData data(file.scene, {method, {}});
      if (solve(file.scene, file.q, file.v, file.u, data).status == Status::kFailed) continue;
      expect_no_estimates(data.report);
      estimate_condition(file.scene, data);
      EXPECT_GE(data.report.condition, 1) << name << ", " << to_string(method);
      EXPECT_TRUE(std::isnan(data.report.error_acceleration));
      for (const IslandReport& island : data.report.islands) EXPECT_TRUE(std::isnan(island.error_forces)) << name;
      estimate_errors(file.scene, data);
      EXPECT_GE(data.report.error_acceleration, 0);
      EXPECT_GE(data.report.error_forces, 0);
      (void)solve(file.scene, file.q, file.v, file.u, data);
      expect_no_estimates(data.report);  // they belong to the last solve, not to an earlier one
    }
  }
}

TEST(Report, HasNoBoundsOfDerivativesThatWereNotRequested) {
  for (const char* name : kScenes) {
    const SceneFile file = load_scene(kModels + name);
    SceneData data(file.scene);
    (void)solve(file.scene, file.q, file.v, file.u, data);
    DerivativeRequest request;
    request.u = false;
    differentiate(file.scene, data, request);
    for (const DerivativeBounds& b : estimate_derivative_errors(file.scene, data)) {
      EXPECT_GT(b.da_dq, 0) << name;
      for (const double x : {b.da_du, b.dforces_du, b.da_dw, b.dforces_dw}) EXPECT_TRUE(std::isnan(x)) << name;
    }
    request.forces = false;
    differentiate(file.scene, data, request);
    for (const DerivativeBounds& b : estimate_derivative_errors(file.scene, data))
      for (const double x : {b.dforces_dq, b.dforces_dv, b.dforces_du}) EXPECT_TRUE(std::isnan(x)) << name;
  }
}

TEST(Report, HasTheTimesOfTheSolve) {
  const SceneFile file = load_scene(kModels + "humanoid_standing.xml");
  SceneData data(file.scene);
  const SolveTimes first = solve(file.scene, file.q, file.v, file.u, data).times;
  EXPECT_GT(first.setup, 0);
  EXPECT_GT(first.solve, 0);
  double setup = first.setup;  // the least: another process may take the core meanwhile
  for (int k = 0; k < 20; ++k) {
    const SolveTimes later = solve_tau(file.scene, file.q, file.v, data.tau, data).times;
    EXPECT_GT(later.solve, 0);
    setup = std::min(setup, later.setup);
  }
  EXPECT_LT(setup, first.setup);  // the islands exist already
}

}  // namespace
}  // namespace manycontact::test
