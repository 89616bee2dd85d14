// Times solves in every precision, with separate robots and in a ring. The label names the precision that was used.

#include <benchmark/benchmark.h>

#include "manycontact/dynamics/solve.hpp"
#include "scenes.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

void in_precision(benchmark::State& state, const Posed& s, Precision precision) {
  Options options;
  options.precision = precision;
  SceneData data(s.scene, options);
  for (auto _ : state) {
    benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
    benchmark::ClobberMemory();
  }
  state.SetLabel(to_string(data.report.islands.front().precision));
}

const Registration registered([] {
  for (const int n : {1, 256, 1024})
    for (const bool ring : {false, true})
      for (const Precision precision : kPrecisions) {
        if (ring && n == 1) continue;
        const std::string name =
            "precision/" + to_string(precision) + "/" + (ring ? "ring/" : "robots/") + std::to_string(n);
        benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
          in_precision(state, robots(n, ring), precision);
        })->Unit(benchmark::kMicrosecond);
      }
});

}  // namespace
}  // namespace manycontact::bench
