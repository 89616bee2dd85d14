// Times whole solves, derivatives and products: N robots, separate or hand in hand in a ring, every method.

#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/views.hpp"
#include "scenes.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

void solve_scene(benchmark::State& state, int robots, bool hand_in_hand, Method method) {
  const Posed s = bench::robots(robots, hand_in_hand);
  SceneData data(s.scene, {method, {}});
  benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  for (auto _ : state) benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  state.counters["us_per_robot"] =
      benchmark::Counter(robots * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["status"] = static_cast<double>(data.report.status);
}

// Times a solve of a herd of quadrupeds with one contact switched off or on again, a different one each time; these
// contact sets were solved before. The reference is a solve of the whole herd.
void switch_contact(benchmark::State& state, int robots, bool switched) {
  const Posed s = herd(robots);
  SceneData data(s.scene);
  std::size_t c = 0;
  const auto toggle_and_solve = [&] {
    if (switched) data.active[c] = !data.active[c];
    benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
    if (data.active[c]) c = (c + robots + 1) % data.active.size();  // another robot's other foot
  };
  for (int k = 0; k < 20; ++k) toggle_and_solve();  // each foot was lifted in one of them
  for (auto _ : state) toggle_and_solve();
}

void differentiate_scene(benchmark::State& state, int robots, bool hand_in_hand, Method method) {
  const Posed s = bench::robots(robots, hand_in_hand);
  SceneData data(s.scene, {method, {}});
  benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  benchmark::DoNotOptimize(differentiate(s.scene, data));
  for (auto _ : state) benchmark::DoNotOptimize(differentiate(s.scene, data));
  state.counters["us_per_robot"] =
      benchmark::Counter(robots * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void products_scene(benchmark::State& state, int robots, bool hand_in_hand, bool transposed) {
  const Posed s = bench::robots(robots, hand_in_hand);
  SceneData data(s.scene);
  benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(s.scene.nv, 0.1), w = Eigen::VectorXd::Constant(s.scene.nu, 0.1);
  Eigen::VectorXd f = Eigen::VectorXd::Constant(data.f.size(), 0.1), y = x, z = x, u = w;
  for (auto _ : state) {
    if (transposed)
      vjp(s.scene, data, x, f, y, z, u);
    else
      jvp(s.scene, data, x, x, w, y, f);
    benchmark::ClobberMemory();
  }
}

// Times the work of dense-schur in plain Eigen with its sizes: LLT of M, L^-1 J^T, S, LLT of S.
void eigen_factors(benchmark::State& state, int robots) {
  const Posed s = bench::robots(robots);
  SceneData data(s.scene, {Method::kDenseSchur, {}});
  (void)solve(s.scene, s.q, s.v, s.u, data);
  const Eigen::MatrixXd all = kkt_matrix(s.scene, data, 0);
  const int nv = s.scene.nv, nc = static_cast<int>(all.rows()) - nv;
  const Eigen::MatrixXd M = all.topLeftCorner(nv, nv), J = all.bottomLeftCorner(nc, nv);
  Eigen::LLT<Eigen::MatrixXd> llt_M(nv), llt_S(nc);
  Eigen::MatrixXd Z = J.transpose(), S(nc, nc);
  for (auto _ : state) {
    llt_M.compute(M);
    Z = J.transpose();
    llt_M.matrixL().solveInPlace(Z);
    S.setZero();
    S.selfadjointView<Eigen::Lower>().rankUpdate(Z.transpose());
    llt_S.compute(S);
    benchmark::DoNotOptimize(llt_S);
  }
}

const Registration registered([] {
  for (const bool ring : {false, true})
    for (int n : {1, 4, 16, 64, 256})
      for (Method m : kMethods) {
        const bool dense_too_large = (n > 64 && m == Method::kDenseSchur) || (n > 16 && ring && m == Method::kDense) ||
                                     (n > 16 && m == Method::kDenseSchur && ring);
        if (dense_too_large || (ring && n == 1)) continue;
        const std::string name =
            std::string("solve/") + (ring ? "ring/" : "separate/") + std::to_string(n) + "/" + to_string(m);
        benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& s) {
          solve_scene(s, n, ring, m);
        })->Unit(benchmark::kMicrosecond);
        const bool slow = m != Method::kSparseLdl && m != Method::kAuto;
        if (m == Method::kDense || (n > 16 && (slow || ring))) continue;  // an island's derivatives are dense
        const std::string derivatives =
            std::string("derivatives/") + (ring ? "ring/" : "separate/") + std::to_string(n) + "/" + to_string(m);
        benchmark::RegisterBenchmark(derivatives.c_str(), [=](benchmark::State& s) {
          differentiate_scene(s, n, ring, m);
        })->Unit(benchmark::kMicrosecond);
      }
  for (const bool ring : {false, true})
    for (int n : {1, 16, 256})
      for (const bool transposed : {false, true}) {
        const std::string name =
            std::string(transposed ? "vjp/" : "jvp/") + (ring ? "ring/" : "separate/") + std::to_string(n);
        if (ring && n == 1) continue;
        benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& s) {
          products_scene(s, n, ring, transposed);
        })->Unit(benchmark::kMicrosecond);
      }
  for (const bool switched : {false, true})
    benchmark::RegisterBenchmark(switched ? "switch/herd/256/one contact" : "switch/herd/256/steady",
                                 [=](benchmark::State& s) { switch_contact(s, 256, switched); })
        ->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("eigen/separate/16", [](benchmark::State& s) {
    eigen_factors(s, 16);
  })->Unit(benchmark::kMicrosecond);
});

}  // namespace
}  // namespace manycontact::bench
