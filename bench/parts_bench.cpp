// The parts of one solve, on one robot with both feet held in 6D. `ldl_numeric` is SuiteSparse's, plain, on the same K:
// the unit that ratios are quoted in.

#include <benchmark/benchmark.h>

#include "manycontact/algorithm/aba.hpp"
#include "manycontact/algorithm/rnea.hpp"
#include "manycontact/algorithm/rnea_derivatives.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "scenes.hpp"

namespace manycontact::bench {
namespace {

// One robot after a solve.
struct Fixture {
  SceneFile s;
  SceneData data;
  const Model& model;
  RobotData& robot;
  Eigen::VectorXd qdd, tau;

  explicit Fixture(SceneFile scene)
      : s(std::move(scene)),
        data(s.scene, {Method::kSparseLdl, Order::kLeafToRoot}),
        model(*s.scene.robots[0].model),
        robot(data.robots[0]) {
    benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
    qdd = data.a;
    tau = Eigen::VectorXd::Zero(model.nv);
  }
};

void ldl_numeric(benchmark::State& state, Fixture& f) {
  IslandData& d = f.data.islands[0];
  const KktPattern& p = *d.system.pattern;
  for (auto _ : state)
    benchmark::DoNotOptimize(
        sparse::ldl_factor(p.K, p.ldl, d.system.Kx.data(), f.data.ldl_work, d.Lx.data(), d.D.data()));
}

void kinematics(benchmark::State& state, Fixture& f) {
  for (auto _ : state) forward_kinematics<double>(f.model, {}, f.s.q, f.robot.kin);
}

void rnea_whole(benchmark::State& state, Fixture& f) {
  for (auto _ : state)
    rnea<double>(f.model, {}, f.s.q, f.s.v, f.qdd, f.s.scene.gravity, {}, f.robot.kin, f.robot.f, f.tau);
}

void aba_whole(benchmark::State& state, Fixture& f) {
  AbaData<double> aba_data(f.model);
  Eigen::VectorXd qdd(f.model.nv);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        aba<double>(f.model, {}, f.s.q, f.s.v, f.tau, f.s.scene.gravity, {}, f.robot.kin, aba_data, qdd));
}

void crba_alone(benchmark::State& state, Fixture& f) {
  for (auto _ : state) crba<double>(f.model, f.robot.kin, f.robot.Yc, f.robot.M.data());
}

void rows(benchmark::State& state, Fixture& f) {
  for (auto _ : state)
    for (std::size_t c = 0; c < f.s.scene.contacts.size(); ++c)
      contact_rows<double>(f.s.scene, f.s.scene.contacts[c], f.data.supports[c], f.robot.kin, nullptr,
                           f.data.contacts[c]);
}

void assemble_k(benchmark::State& state, Fixture& f) {
  IslandData& d = f.data.islands[0];
  for (auto _ : state) assemble(d.M, d.J, 0, d.system);
}

void triangular_solve(benchmark::State& state, Fixture& f) {
  IslandData& d = f.data.islands[0];
  for (auto _ : state) {
    d.system.x = d.system.b;
    sparse::ldl_solve(d.system.pattern->ldl, d.Lx.data(), d.D.data(), d.system.x.data());
  }
}

void residual(benchmark::State& state, Fixture& f) {
  for (auto _ : state) benchmark::DoNotOptimize(backward_error(f.data.islands[0].system));
}

void solve_whole(benchmark::State& state, Fixture& f) {
  for (auto _ : state) benchmark::DoNotOptimize(solve(f.s.scene, f.s.q, f.s.v, f.s.u, f.data));
}

void rnea_derivatives_whole(benchmark::State& state, Fixture& f) {
  RneaDerivatives d(f.model);
  for (auto _ : state) {
    forward_kinematics<double>(f.model, {}, f.s.q, f.robot.kin);
    forward_accelerations<double>(f.model, f.s.v, f.qdd.data(), f.s.scene.gravity, f.robot.kin);
    f.robot.Yc = f.robot.kin.Y;
    for (int i = f.model.njoints() - 1; i > 0; --i) f.robot.Yc[f.model.joints[i].parent] += f.robot.Yc[i];
    rnea_derivatives(f.model, f.robot.kin, f.robot.Yc, {}, d);
    benchmark::DoNotOptimize(d);
  }
}

// All derivatives, after a solve.
void differentiate_whole(benchmark::State& state, Fixture& f) {
  benchmark::DoNotOptimize(solve(f.s.scene, f.s.q, f.s.v, f.s.u, f.data));
  for (auto _ : state) benchmark::DoNotOptimize(differentiate(f.s.scene, f.data));
}

void register_robot(const std::string& name, SceneFile scene) {
  auto* f = new Fixture(std::move(scene));  // lives as long as the program
  const auto add = [&](const char* part, void (*run)(benchmark::State&, Fixture&)) {
    benchmark::RegisterBenchmark(("parts/" + name + "/" + part).c_str(), [=](benchmark::State& s) {
      run(s, *f);
    })->Unit(benchmark::kMicrosecond);
  };
  add("ldl_numeric", ldl_numeric);
  add("forward_kinematics", kinematics);
  add("rnea", rnea_whole);
  add("aba", aba_whole);
  add("crba", crba_alone);
  add("contact_rows", rows);
  add("assemble", assemble_k);
  add("triangular_solve", triangular_solve);
  add("residual", residual);
  add("solve", solve_whole);
  add("rnea_derivatives", rnea_derivatives_whole);
  add("derivatives", differentiate_whole);
}

const bool registered = [] {
  register_robot("humanoid", humanoids(1, false));
  if (talos_available()) register_robot("talos", talos(1));
  return true;
}();

}  // namespace
}  // namespace manycontact::bench
