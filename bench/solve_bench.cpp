// Whole solves: N humanoids, separate or hand in hand in a ring, every method.

#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>

#include "manycontact/dynamics/solve.hpp"
#include "scenes.hpp"

namespace manycontact::bench {
namespace {

void solve_scene(benchmark::State& state, int robots, bool hand_in_hand, Method method) {
  const SceneFile s = humanoids(robots, hand_in_hand);
  SceneData data(s.scene, {method, {}});
  benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  for (auto _ : state) benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  state.counters["us_per_robot"] =
      benchmark::Counter(robots * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["status"] = static_cast<double>(data.report.status);
}

// What dense-schur cannot do without, by plain Eigen on matrices of its sizes: LLT of M, L^-1 J^T, S, LLT of S.
void eigen_factors(benchmark::State& state, int robots) {
  const SceneFile s = humanoids(robots, false);
  SceneData data(s.scene, {Method::kDenseSchur, {}});
  benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  const DenseSchurData& d = data.dense_schur;
  Eigen::LLT<Eigen::MatrixXd> llt_M(d.M.rows()), llt_S(d.S.rows());
  Eigen::MatrixXd Z = d.Z, S = d.S;
  for (auto _ : state) {
    llt_M.compute(d.M);
    Z = d.J.transpose();
    llt_M.matrixL().solveInPlace(Z);
    S.setZero();
    S.selfadjointView<Eigen::Lower>().rankUpdate(Z.transpose());
    llt_S.compute(S);
    benchmark::DoNotOptimize(llt_S);
  }
}

const bool registered = [] {
  for (const bool ring : {false, true})
    for (int n : {1, 4, 16, 64, 256})
      for (Method m : kMethods) {
        const bool dense_too_large = (n > 64 && m == Method::kDenseSchur) || (n > 16 && ring && m == Method::kDense) ||
                                     (n > 16 && m == Method::kDenseSchur && ring);
        if (dense_too_large || (ring && n == 1)) continue;
        const std::string name =
            std::string("solve/") + (ring ? "ring/" : "separate/") + std::to_string(n) + "/" + to_string(m);
        benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& s) { solve_scene(s, n, ring, m); })
            ->Unit(benchmark::kMicrosecond);
      }
  benchmark::RegisterBenchmark("eigen/separate/16", [](benchmark::State& s) { eigen_factors(s, 16); })
      ->Unit(benchmark::kMicrosecond);
  return true;
}();

}  // namespace
}  // namespace manycontact::bench
