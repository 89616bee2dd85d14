// Times directions of linear-quadratic problems of humanoids' sizes: factorize, and solve with its error check.
// Exponents in the number of robots are fitted to lq/separate and lq/chain; lq/dense grows with its cube.

#include <benchmark/benchmark.h>

#include <limits>

#include "../tests/lq/random_problem.hpp"
#include "manycontact/lq/coupling_schur.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

constexpr int kStates = 76, kControls = 32;

lq::Problem separate(int robots, int horizon, bool one_block) {
  std::mt19937 rng(1);
  test::LqOptions options;
  options.horizon = horizon;
  if (one_block) {
    options.nx = {robots * kStates};
    options.nu = {robots * kControls};
  } else {
    options.nx.assign(robots, kStates);
    options.nu.assign(robots, kControls);
  }
  return test::random_lq(rng, options);
}

lq::Problem chain(int robots, int horizon) {
  std::mt19937 rng(1);
  return test::chain_of_robots(robots, horizon, rng, kStates, kControls);
}

void report(benchmark::State& state, const lq::DirectionSolver& solver, const lq::Outcome& outcome) {
  state.counters["status"] = static_cast<double>(outcome.status);
  state.counters["Gflop"] = solver.flops() * 1e-9;  // operations of factorize
  state.counters["kkt_error_in_eps"] = outcome.kkt_error / std::numeric_limits<double>::epsilon();
}

void factorize(benchmark::State& state, lq::DirectionSolver& solver, const lq::Problem& problem) {
  solver.analyse(problem);
  lq::Outcome outcome;
  for (auto _ : state) outcome = solver.factorize(problem);
  report(state, solver, outcome);
}

void solve(benchmark::State& state, lq::DirectionSolver& solver, const lq::Problem& problem) {
  solver.analyse(problem);
  lq::Outcome outcome = solver.factorize(problem);
  lq::Point z;
  for (auto _ : state) outcome = solver.solve(problem, z);
  report(state, solver, outcome);
}

template <class Run>
void add(const std::string& name, Run run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond);
}

const Registration registered([] {
  for (const int robots : {1, 2, 4, 8, 16, 32, 64}) {
    if (settings().quick && robots != 1 && robots != 16) continue;
    const std::string n = std::to_string(robots);
    add("lq/separate/" + n + "/factorize", [=](benchmark::State& s) {
      lq::Riccati solver(lq::Join::kIslands);
      factorize(s, solver, separate(robots, 50, false));
    });
    add("lq/separate/" + n + "/solve", [=](benchmark::State& s) {
      lq::Riccati solver(lq::Join::kIslands);
      solve(s, solver, separate(robots, 50, false));
    });
    if (robots == 1 || robots == 64) continue;
    add("lq/chain/" + n + "/factorize", [=](benchmark::State& s) {
      lq::CouplingSchur solver;
      factorize(s, solver, chain(robots, 50));
    });
    add("lq/chain/" + n + "/solve", [=](benchmark::State& s) {
      lq::CouplingSchur solver;
      solve(s, solver, chain(robots, 50));
    });
  }
  // The dense recursion has five knots instead of fifty and takes a tenth of the time.
  for (const int robots : {1, 2, 4, 8, 16}) {
    if (settings().quick && robots != 16) continue;
    add("lq/dense_5_knots/" + std::to_string(robots) + "/factorize", [=](benchmark::State& s) {
      lq::Riccati solver(lq::Join::kAll);
      factorize(s, solver, separate(robots, 5, true));
    });
  }
});

}  // namespace
}  // namespace manycontact::bench
