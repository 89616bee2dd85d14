// Times N separate robots of the measured model in SIMD batches, at each instruction level of this machine.

#include <benchmark/benchmark.h>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "scenes.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

enum class What { kSolve, kDerivatives, kVjp };

void in_lanes(benchmark::State& state, int robots, SimdLevel lanes, What what) {
  const Posed s = bench::robots(robots);
  SceneData data(s.scene, {Method::kSparseLdl, {}, lanes});
  benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  if (what == What::kDerivatives) benchmark::DoNotOptimize(differentiate(s.scene, data));
  Eigen::VectorXd wa = Eigen::VectorXd::Ones(s.scene.nv), wf = Eigen::VectorXd::Ones(data.f.size());
  Eigen::VectorXd wq(s.scene.nv), wv(s.scene.nv), wu(s.scene.nu);
  for (auto _ : state) {
    if (what == What::kSolve) benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
    if (what == What::kDerivatives) benchmark::DoNotOptimize(differentiate(s.scene, data));
    if (what == What::kVjp) vjp(s.scene, data, wa, wf, wq, wv, wu);
    benchmark::ClobberMemory();
  }
  state.counters["us_per_robot"] =
      benchmark::Counter(robots * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

const Registration registered([] {
  std::vector<SimdLevel> all = available_simd_levels();
  all.push_back(SimdLevel::kOff);
  for (const SimdLevel lanes : all)
    for (const int n : {1, 16, 256, 1024})
      for (const What what : {What::kSolve, What::kDerivatives, What::kVjp}) {
        const char* names[] = {"solve", "derivatives", "vjp"};
        const std::string name =
            "lanes/" + to_string(lanes) + "/" + std::to_string(n) + "/" + names[static_cast<int>(what)];
        benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& s) {
          in_lanes(s, n, lanes, what);
        })->Unit(benchmark::kMicrosecond);
      }
});

}  // namespace
}  // namespace manycontact::bench
