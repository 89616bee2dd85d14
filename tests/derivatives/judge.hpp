#pragma once
// Every method's derivatives of a scene are compared with differences of the truth; the worst errors are printed.

#include <cstdio>

#include "derivatives/differences.hpp"
#include "support/methods.hpp"

namespace manycontact::test {

/// Errors are usually far below the allowed ones; a loss of digits should be noticed nevertheless.
inline constexpr double kExpected = 1e-9;

inline void print_row(const std::string& scene, double condition, const DerivativeErrors& e, const std::string& worst) {
  static bool first = true;
  if (first) {
    std::printf("%-46s %9s", "worst errors", "condition");
    for (const char* quantity : kQuantities) std::printf(" %10s", quantity);
    std::printf(" %8s by\n", "/allowed");
  }
  first = false;
  std::printf("%-46s %9.1e", scene.c_str(), condition);
  for (double error : e.quantity) std::printf(" %10.1e", error);
  std::printf(" %8.1e %s\n", e.excess, worst.c_str());
}

/// Expects that the comparison is meaningful: derivatives are not zero, they are not the differences themselves, and a
/// slightly wrong one is detected.
inline void expect_able_to_fail(const Scene& scene, const Island& island, const Eigen::MatrixXd& answer,
                                const MatX<Quad>& truth, double condition) {
  const std::array<int, 4> kinds = column_kinds(island, truth);
  EXPECT_GT(size_of(answer), 1);
  EXPECT_FALSE(answer == truth.cast<double>());
  Eigen::MatrixXd wrong = answer;
  Eigen::Index row, column;
  wrong.topLeftCorner(island.nv, island.nv).cwiseAbs().maxCoeff(&row, &column);  // of da_dq
  wrong.col(column).head(island.nv) *= 1 + 1e-6;
  EXPECT_GT(derivative_errors(scene, island, wrong, truth, kinds, condition).excess, 1);
}

/// Expects that the requested method solved the island. Contacts may be eliminated too early for sound pivots; then
/// another order or the dense reference solver is used.
inline void expect_no_fallback(const Options& asked, const IslandReport& report) {
  if (asked.method == Method::kAuto || !asked.order || asked.order == Order::kContactsEarly) return;
  EXPECT_EQ(report.method, asked.method);
  EXPECT_EQ(report.order, *asked.order);
}

/// Returns an island's block of the derivatives, [a; f] by [q | v | u]. The baseline has one block of the whole scene.
inline Eigen::MatrixXd answer_of(const Scene& scene, const SceneData& data, const Island& island, std::size_t i) {
  const DerivativeData& dd = derivatives(data);
  if (data.options.method != Method::kDenseSchur) return dd.islands[i].X.leftCols(dd.islands[i].cols);
  const Places p(scene, data, island);
  const Eigen::MatrixXd whole(sparse_derivatives(scene, data));
  std::vector<int> rows = p.v, columns = p.v;
  for (int f : p.f) rows.push_back(scene.nv + f);
  for (int v : p.v) columns.push_back(scene.nv + v);
  for (int u : p.u) columns.push_back(2 * scene.nv + u);
  return whole(rows, columns);
}

/// Expects errors of an island's matrices within the bounds of estimate_derivative_errors.
inline void expect_true_bounds(const Island& island, const Eigen::MatrixXd& answer, const MatX<Quad>& truth,
                               const DerivativeBounds& bounds) {
  const double of[2][3] = {{bounds.da_dq, bounds.da_dv, bounds.da_du},
                           {bounds.dforces_dq, bounds.dforces_dv, bounds.dforces_du}};
  const std::array<int, 4> first = column_kinds(island, truth);
  for (int rows = 0; rows < 2; ++rows)
    for (int kind = 0; kind < 3; ++kind) {
      const auto block = [&](const auto& x) {
        return x.block(rows * island.nv, first[kind], rows ? island.nc : island.nv, first[kind + 1] - first[kind])
            .eval();
      };
      const Eigen::MatrixXd mine = block(answer);
      if (mine.size() == 0) continue;
      const double error = static_cast<double>((block(truth) - mine.cast<Quad>()).cwiseAbs().maxCoeff());
      EXPECT_TRUE(std::isfinite(of[rows][kind])) << "qvu"[kind];
      EXPECT_LE(error, of[rows][kind] * mine.cwiseAbs().maxCoeff()) << (rows ? "forces " : "a ") << "qvu"[kind];
    }
}

/// Compares all six matrices, with every method in every order, of a scene with the given status. Prints a row.
inline void expect_differences(const std::string& name, const Scene& scene, const State& s, Status status) {
  SCOPED_TRACE(name);
  SceneData oracle(scene, {Method::kDense, {}});
  ASSERT_EQ(solve(scene, s.q, s.v, s.u, oracle).status, status);
  const std::vector<double> condition = conditions(scene, oracle);
  const std::vector<MatX<Quad>> truth = differences(scene, oracle, s);
  DerivativeErrors all;
  std::string worst;
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(scene, way.options);
    (void)solve(scene, s.q, s.v, s.u, data);
    const DerivativeData& dd = differentiate_afresh(scene, data);
    if (way.options.method == Method::kDenseSchur && status != Status::kOk) {
      for (const IslandDerivatives& d : dd.islands) EXPECT_TRUE(d.X.array().isNaN().all());
      continue;
    }
    EXPECT_EQ(data.report.status, status);
    DerivativeErrors e;
    const std::vector<Island> islands = islands_at(scene, data);
    const std::vector<DerivativeBounds> bounds = estimate_derivative_errors(scene, data);
    for (std::size_t i = 0; i < islands.size(); ++i) {
      const Island& island = islands[i];
      const Eigen::MatrixXd answer = answer_of(scene, data, island, i);
      e.add(derivative_errors(scene, island, answer, truth[i], column_kinds(island, truth[i]), condition[i]));
      if (status == Status::kOk && way.options.method != Method::kDenseSchur)
        expect_no_fallback(way.options, data.report.islands[i]);
      if (bounds.size() == islands.size())
        expect_true_bounds(island, answer, truth[i], bounds[i]);  // otherwise one system
      if (way.options.method == Method::kDense) expect_able_to_fail(scene, island, answer, truth[i], condition[i]);
    }
    EXPECT_LE(e.excess, 1);
    for (double error : e.quantity) EXPECT_LE(error, kExpected);
    if (!(e.excess <= all.excess)) worst = way.name;
    all.add(e);
  }
  print_row(name + ", " + to_string(status), oracle.report.condition, all, worst);
}

/// Returns the status of the dense reference solver.
inline Status status_at(const Scene& scene, const State& s) {
  SceneData data(scene, {Method::kDense, {}});
  return solve(scene, s.q, s.v, s.u, data).status;
}

inline int largest_island(const Scene& scene) {
  int largest = 0;
  for (const Island& island : islands_at(scene, SceneData(scene))) largest = std::max(largest, island.nv);
  return largest;
}

}  // namespace manycontact::test
