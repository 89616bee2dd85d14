// Times ABA of the chains without their contacts, in addition to the sweep over chains.

#include <benchmark/benchmark.h>

#include "manycontact/algorithm/aba.hpp"
#include "scenes.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

void aba_chain(benchmark::State& state, int links) {
  const Posed c = chain(links);
  const Model& model = *c.scene.robots[0].model;
  Kinematics<double> kin(model);
  AbaData<double> data(model);
  Eigen::VectorXd qdd(model.nv);
  for (auto _ : state)
    benchmark::DoNotOptimize(aba<double>(model, {}, c.q, c.v, c.u, c.scene.gravity, {}, kin, data, qdd));
}

const Registration registered([] {
  for (const int n : {10, 100, 1000, 10000, 100000}) {
    if (settings().quick && n > 10000) continue;
    benchmark::RegisterBenchmark(("sweep/chain/" + std::to_string(n) + "/ABA").c_str(), [n](benchmark::State& s) {
      aba_chain(s, n);
    })->Unit(benchmark::kMicrosecond);
  }
});

}  // namespace
}  // namespace manycontact::bench
