// Times batches of 64 states in one and two threads: elapsed time, not one thread's processor time.

#include <benchmark/benchmark.h>

#include "manycontact/dynamics/batch.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "scenes.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

enum class Work { kSolve, kDifferentiate, kVjp };

void batch_of_states(benchmark::State& state, int robots, Work work, int threads) {
  constexpr int kStates = 64;
  const Posed s = bench::robots(robots);
  const Scene& scene = s.scene;
  const auto repeated = [](const Eigen::VectorXd& x) -> BatchMatrix { return x.transpose().replicate(kStates, 1); };
  const BatchMatrix q = repeated(s.q), v = repeated(s.v), u = repeated(s.u);
  BatchData batch(scene, threads);
  const int nf = force_rows(scene, batch);
  BatchMatrix A = v, F = BatchMatrix::Zero(kStates, nf), WA = v, WF = F, WQ = v, WV = v, WU = u, D;
  if (work == Work::kDifferentiate) D.resize(kStates, (scene.nv + nf) * (2 * scene.nv + scene.nu));
  std::vector<Status> status(kStates);
  const auto once = [&] {
    if (work == Work::kSolve) solve_batch(scene, {q, v, u}, batch, A, F, status);
    if (work == Work::kDifferentiate) differentiate_batch(scene, {q, v, u}, batch, A, F, D, status);
    if (work == Work::kVjp) vjp_batch(scene, {q, v, u}, WA, WF, batch, WQ, WV, WU, status);
    benchmark::ClobberMemory();
  };
  once();
  for (auto _ : state) once();
  state.counters["us_per_robot"] = benchmark::Counter(
      robots * kStates * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Times the same work on one scene of 64 copies, as the reference for a batch.
void scene_of_copies(benchmark::State& state, Work work) {
  const Posed s = bench::robots(64);
  Options options;
  options.threads = 1;
  SceneData data(s.scene, options);
  (void)solve(s.scene, s.q, s.v, s.u, data);
  const Eigen::VectorXd wa = s.v, wf = data.f;
  Eigen::VectorXd wq = s.v, wv = s.v, wu = s.u;
  const auto once = [&] {
    (void)solve(s.scene, s.q, s.v, s.u, data);
    if (work == Work::kDifferentiate) (void)differentiate(s.scene, data);
    if (work == Work::kVjp) vjp(s.scene, data, wa, wf, wq, wv, wu);
    benchmark::ClobberMemory();
  };
  once();
  for (auto _ : state) once();
  state.counters["us_per_robot"] =
      benchmark::Counter(64e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

const Registration registered([] {
  const std::pair<Work, const char*> works[] = {
      {Work::kSolve, "solve"}, {Work::kDifferentiate, "differentiate"}, {Work::kVjp, "vjp"}};
  for (const auto& [work, name] : works)
    benchmark::RegisterBenchmark((std::string("batch/") + name + "/scene_of_64").c_str(),
                                 [w = work](benchmark::State& s) { scene_of_copies(s, w); })
        ->Unit(benchmark::kMicrosecond)
        ->UseRealTime();
  for (const auto& [work, name] : works)
    for (int robots : {1, 4})
      for (int threads : {1, 2}) {
        const std::string full = std::string("batch/") + name + "/separate/" + std::to_string(robots) +
                                 "/threads:" + std::to_string(threads);
        benchmark::RegisterBenchmark(full.c_str(),
                                     [=, w = work](benchmark::State& s) { batch_of_states(s, robots, w, threads); })
            ->Unit(benchmark::kMicrosecond)
            ->UseRealTime();
      }
});

}  // namespace
}  // namespace manycontact::bench
