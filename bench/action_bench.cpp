// The action model, and redundant contacts against the same scene with a damping.

#include <benchmark/benchmark.h>

#include <filesystem>

#include "manycontact/action.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "scenes.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

struct Action {
  std::shared_ptr<DifferentialActionModelContactFwdDynamics> model;
  std::shared_ptr<DifferentialActionDataAbstract> data;
  Eigen::VectorXd x, u;

  // No costs, as the peers' figures were taken; with `sparse` only the sparse twins are filled.
  Action(const Posed& s, bool sparse) {
    auto state = std::make_shared<StateMultibody>(s.scene);
    auto actuation = std::make_shared<ActuationModelFloatingBase>(state);
    const std::size_t nu = actuation->get_nu();
    model = std::make_shared<DifferentialActionModelContactFwdDynamics>(
        state, actuation, contacts_of_scene(state, s.scene, nu), std::make_shared<CostModelSum>(state, nu));
    if (sparse) model->set_storage(MatrixStorage::kSparse);
    data = model->createData();
    x.resize(s.q.size() + s.v.size());
    x << s.q, s.v;
    u = s.u;
    model->calc(data, x, u);
    model->calcDiff(data, x, u);
  }
};

void action_calc(benchmark::State& state, const Posed& s) {
  Action a(s, false);
  for (auto _ : state) a.model->calc(a.data, a.x, a.u);
}

void action_calc_diff(benchmark::State& state, const Posed& s, bool sparse) {
  Action a(s, sparse);
  for (auto _ : state) a.model->calcDiff(a.data, a.x, a.u);
}

void solve_with_damping(benchmark::State& state, SceneFile s, double damping) {
  s.scene.damping = damping;
  SceneData data(s.scene);
  benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  for (auto _ : state) benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  state.counters["status"] = static_cast<double>(data.report.status);
}

void redundant(const std::string& name, const std::string& path) {
  if (!std::filesystem::exists(path)) return;
  const SceneFile s = load_scene(path);
  benchmark::RegisterBenchmark(("redundant/" + name + "/undamped").c_str(), solve_with_damping, s, 0.0);
  benchmark::RegisterBenchmark(("redundant/" + name + "/damped").c_str(), solve_with_damping, s, 1e-6);
}

const Registration registered([] {
  const std::string source = MANYCONTACT_SOURCE_DIR;
  redundant("feet_on_corners", source + "/models/feet_on_corners.xml");
  redundant("anymal_loop", source + "/../shared/golden/anymal_loop_redundant.xml");
  for (int robots : {1, 16, 64}) {
    const std::string n = std::to_string(robots);
    const Posed s = bench::robots(robots);
    benchmark::RegisterBenchmark(("action/calc/" + n).c_str(), action_calc, s);
    if (robots <= 16) benchmark::RegisterBenchmark(("action/calcDiff/" + n).c_str(), action_calc_diff, s, false);
    benchmark::RegisterBenchmark(("action/calcDiff_sparse/" + n).c_str(), action_calc_diff, s, true);
  }
});

}  // namespace
}  // namespace manycontact::bench
