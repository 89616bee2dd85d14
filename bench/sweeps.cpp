// Times every task of the program over the sizes of each kind of scene: sweep/SCENE/SIZE/TASK.

#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>

#include "manycontact/dynamics/solve.hpp"
#include "programs/program.hpp"
#include "settings.hpp"

namespace manycontact::bench {

namespace {

// Seconds of one call; scenes that would take longer are left out.
constexpr double kLongest = 3, kLongestOfPeers = 0.6;

struct Sweep {
  std::string scene;
  Posed (*make)(int);
  std::vector<int> sizes, quick;
  std::vector<std::string> Program::*tasks = &Program::tasks;
};

const Sweep kSweeps[] = {
    {"separate", [](int n) { return robots(n); }, {1, 2, 4, 8, 16, 64, 256, 1024}, {1, 16, 64}},
    {"ring", [](int n) { return robots(n, true); }, {4, 8, 16, 64, 256, 1024}, {4, 16, 64}},
    {"feet", herd_on_feet, {1, 4, 16, 32, 48, 64}, {16, 64}},
    {"points", on_points, {1, 2, 4, 6, 8, 16, 32}, {2, 8}},
    {"one", [](int n) { return robots(n); }, {1}, {1}, &Program::of_one},
    {"tower", tower, {10, 40, 160, 640, 2500, 10000}, {10, 160}},
    {"table", table, {16, 64, 256, 1024, 4096, 10000}, {16, 256}},
    {"wall", wall, {16, 100, 400, 1600, 3600, 10000}, {16, 100}},
    {"chain", chain, {10, 30, 100, 300, 1000, 10000, 100000}, {10, 100, 1000, 10000}},
};

double heap() {
  const auto m = mallinfo2();
  return static_cast<double>(m.uordblks + m.hblkhd);
}

// The last scene, and the task loaded from it, since a benchmark is called several times.
struct Current {
  std::string scene_key, key;
  Posed scene;
  std::unique_ptr<Loaded> loaded;
  std::string refused;
  double bytes = 0, difference = 0;
};

// Returns the largest difference of accelerations from ours, relative to our largest; negative: not compared.
double difference(const Posed& s, Loaded& loaded) {
  const Eigen::VectorXd a = loaded.accelerations();
  if (a.size() == 0) return -1;
  SceneData data(s.scene);
  (void)solve(s.scene, s.q, s.v, s.u, data);
  return (a - data.a).lpNorm<Eigen::Infinity>() / data.a.lpNorm<Eigen::Infinity>();
}

void load(Current& c, const Sweep& sweep, int size, const std::string& task) {
  const std::string scene_key = sweep.scene + "/" + std::to_string(size), key = scene_key + "/" + task;
  if (c.key == key) return;
  c.loaded.reset();
  c.key = key;
  if (c.scene_key != scene_key) c.scene = sweep.make(size);
  c.scene_key = scene_key;
  c.refused = program().refuses(c.scene, task);
  if (!c.refused.empty()) return;
  malloc_trim(0);
  const double before = heap();
  c.loaded = program().load(c.scene, task);
  c.loaded->run();
  c.bytes = heap() - before;
  c.difference = difference(c.scene, *c.loaded);
}

// Times of one task on one kind of scene so far, ascending in size.
class Growth {
 public:
  // Predicts the seconds at `size`: by the line through the last two times in log-log axes, or the square of the size.
  double at(int size) const {
    if (last_.empty()) return 0;
    const auto [n, t] = last_.back();
    double power = 2;
    if (last_.size() > 1) {
      const auto [n0, t0] = last_[last_.size() - 2];
      power = std::log(t / t0) / std::log(static_cast<double>(n) / n0);
    }
    return t * std::pow(static_cast<double>(size) / n, power);
  }
  void add(int size, double seconds) {
    if (last_.empty() || last_.back().first != size) last_.emplace_back(size, seconds);
    last_.back().second = std::min(last_.back().second, seconds);  // the first call is slower
  }

 private:
  std::vector<std::pair<int, double>> last_;
};

void sweep_task(benchmark::State& state, const Sweep& sweep, int size, const std::string& task) {
  static Current current;
  static std::map<std::string, Growth> times;
  Growth& growth = times[sweep.scene + "/" + task];
  const bool too_long = growth.at(size) > (program().name == "manycontact" ? kLongest : kLongestOfPeers);
  if (!too_long) load(current, sweep, size, task);
  if (too_long || !current.refused.empty()) {
    for (auto _ : state) state.SetIterationTime(1);
    state.counters["skipped"] = 1;
    state.SetLabel(too_long ? "would take too long" : current.refused);
    return;
  }
  std::chrono::duration<double> passed{};
  for (auto _ : state) {
    current.loaded->begin();
    const auto start = std::chrono::steady_clock::now();
    current.loaded->run();
    benchmark::ClobberMemory();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    state.SetIterationTime(time.count());
    passed += time;
  }
  growth.add(size, passed.count() / static_cast<double>(state.iterations()));
  state.counters["bytes"] = current.bytes;
  state.counters["difference"] = current.difference;
}

const Registration registered([] {
  for (const Sweep& sweep : kSweeps)
    for (const int size : settings().quick ? sweep.quick : sweep.sizes)
      for (const std::string& task : program().*sweep.tasks) {
        const std::string name = "sweep/" + sweep.scene + "/" + std::to_string(size) + "/" + task;
        benchmark::RegisterBenchmark(name.c_str(),
                                     [&sweep, size, task](benchmark::State& s) { sweep_task(s, sweep, size, task); })
            ->Unit(benchmark::kMicrosecond)
            ->UseManualTime();
      }
});

}  // namespace

}  // namespace manycontact::bench
