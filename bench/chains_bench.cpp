// Chains held at every tenth link: time of a link over the number of links; ABA's without the contacts beside it.

#include <benchmark/benchmark.h>

#include "../tests/support/chains.hpp"
#include "manycontact/algorithm/aba.hpp"
#include "manycontact/dynamics/jvp.hpp"

namespace manycontact::bench {
namespace {

using test::Chain;

Chain chain(int links) {
  test::ChainOptions options;
  options.links = links;
  return make_chain(options);
}

void per_link(benchmark::State& state, int links) {
  state.counters["ns_per_link"] =
      benchmark::Counter(links * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void solve_chain(benchmark::State& state, int links) {
  const Chain c = chain(links);
  SceneData data(c.scene);
  for (auto _ : state) benchmark::DoNotOptimize(solve(c.scene, c.q, c.v, c.u, data));
  state.counters["status"] = static_cast<double>(data.report.status);
  per_link(state, links);
}

void vjp_chain(benchmark::State& state, int links) {
  const Chain c = chain(links);
  SceneData data(c.scene);
  benchmark::DoNotOptimize(solve(c.scene, c.q, c.v, c.u, data));
  Eigen::VectorXd a = c.v, f = data.f, q = c.v, v = c.v, u = c.u;
  for (auto _ : state) {
    vjp(c.scene, data, a, f, q, v, u);
    benchmark::ClobberMemory();
  }
  per_link(state, links);
}

void aba_chain(benchmark::State& state, int links) {
  const Chain c = chain(links);
  const Model& model = *c.scene.robots[0].model;
  Kinematics<double> kin(model);
  AbaData<double> data(model);
  Eigen::VectorXd qdd(model.nv);
  for (auto _ : state)
    benchmark::DoNotOptimize(aba<double>(model, {}, c.q, c.v, c.u, c.scene.gravity, {}, kin, data, qdd));
  per_link(state, links);
}

void set_up_chain(benchmark::State& state, int links) {
  const Chain c = chain(links);
  for (auto _ : state) {
    SceneData data(c.scene);
    benchmark::DoNotOptimize(data.a.data());
  }
  per_link(state, links);
}

const bool registered = [] {
  for (const int n : {10, 100, 1000, 10000, 100000}) {
    const auto add = [n](const char* what, void (*run)(benchmark::State&, int)) {
      benchmark::RegisterBenchmark(("chain/" + std::string(what) + "/" + std::to_string(n)).c_str(),
                                   [=](benchmark::State& s) { run(s, n); })
          ->Unit(benchmark::kMicrosecond);
    };
    add("solve", solve_chain);
    add("vjp", vjp_chain);
    add("aba", aba_chain);
    add("set_up", set_up_chain);
  }
  return true;
}();

}  // namespace
}  // namespace manycontact::bench
