// Times the parts of a solve on one robot, both feet fixed in 6D. `ldl_numeric` (SuiteSparse) is the unit of ratios.

#include <benchmark/benchmark.h>

#include "manycontact/algorithm/aba.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/detail/algorithm/rnea_derivatives.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"
#include "manycontact/sparse/refine.hpp"
#include "scenes.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

// One robot after a solve, and the workspace of the parts.
struct Fixture {
  Posed s;
  SceneData data;
  const Model& model;
  Eigen::VectorXd qdd, tau;
  Kinematics<double> kin;
  std::vector<Inertia<double>> Yc;
  std::vector<Vec6<double>> f;
  std::vector<double> M;
  std::vector<ContactData<double>> contacts;
  std::vector<std::span<const double>> M_spans, J_spans;
  KktMatrix K;
  KktVectors v;
  sparse::LdlWorkspace work;
  std::vector<double> Lx, D, scale;

  explicit Fixture(Posed scene)
      : s(std::move(scene)),
        data(s.scene, {Method::kSparseLdl, Order::kLeafToRoot}),
        model(*s.scene.robots[0].model),
        kin(model),
        Yc(model.njoints()),
        f(model.njoints()),
        M(model.M_begin[model.nv]) {
    (void)solve(s.scene, s.q, s.v, s.u, data);
    qdd = data.a;
    tau = Eigen::VectorXd::Zero(model.nv);
    kin = robot_kinematics(s.scene, data, 0);
    crba<double>(model, kin, Yc, M.data());
    M_spans.emplace_back(M);
    for (std::size_t c = 0; c < s.scene.contacts.size(); ++c)
      contacts.push_back(contact_data(s.scene, data, static_cast<int>(c)));
    for (const ContactData<double>& c : contacts) J_spans.emplace_back(c.J.data(), c.J.size());
    K = assembled_matrix_of(s.scene, data, 0);
    v.resize(K.size());
    for (int k = 0; k < K.size(); ++k) v.b[k] = v.x[k] = std::sin(k + 1.0);
    Lx.resize(K.pattern->ldl.nonzeros());
    D.resize(K.size());
    scale.resize(K.size());
    benchmark::DoNotOptimize(factor());
  }
  int factor() { return sparse::ldl_factor(K.pattern->K, K.pattern->ldl, K.values.data(), work, Lx.data(), D.data()); }
};

void ldl_numeric(benchmark::State& state, Fixture& f) {
  for (auto _ : state) benchmark::DoNotOptimize(f.factor());
}

void ldl_scheduled(benchmark::State& state, Fixture& f) {
  const sparse::LdlSchedule& schedule = f.K.pattern->schedule();
  for (auto _ : state) {
    sparse::ldl_scheduled_factor(schedule, f.K.values.data(), f.Lx.data(), f.D.data(), f.scale.data());
    benchmark::DoNotOptimize(f.D.data());
  }
}

void kinematics(benchmark::State& state, Fixture& f) {
  for (auto _ : state) forward_kinematics<double>(f.model, {}, f.s.q, f.kin);
}

void rnea_whole(benchmark::State& state, Fixture& f) {
  for (auto _ : state) rnea<double>(f.model, {}, f.s.q, f.s.v, f.qdd, f.s.scene.gravity, {}, f.kin, f.f, f.tau);
}

void aba_whole(benchmark::State& state, Fixture& f) {
  AbaData<double> aba_data(f.model);
  Eigen::VectorXd qdd(f.model.nv);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        aba<double>(f.model, {}, f.s.q, f.s.v, f.tau, f.s.scene.gravity, {}, f.kin, aba_data, qdd));
}

void crba_alone(benchmark::State& state, Fixture& f) {
  for (auto _ : state) crba<double>(f.model, f.kin, f.Yc, f.M.data());
}

void rows(benchmark::State& state, Fixture& f) {
  for (auto _ : state)
    for (std::size_t c = 0; c < f.s.scene.contacts.size(); ++c)
      contact_rows<double>(f.s.scene, f.s.scene.contacts[c], contact_support(f.s.scene, f.data, static_cast<int>(c)),
                           f.kin, nullptr, f.contacts[c]);
}

void assemble_k(benchmark::State& state, Fixture& f) {
  for (auto _ : state) assemble(f.M_spans, f.J_spans, 0, f.K);
}

void triangular_solve(benchmark::State& state, Fixture& f) {
  for (auto _ : state) {
    f.v.x = f.v.b;
    sparse::ldl_solve(f.K.pattern->ldl, f.Lx.data(), f.D.data(), f.v.x.data());
  }
}

void scheduled_solve(benchmark::State& state, Fixture& f) {
  for (auto _ : state) {
    f.v.x = f.v.b;
    sparse::ldl_scheduled_solve(f.K.pattern->schedule(), f.Lx.data(), f.D.data(), f.v.x.data());
  }
}

void residual(benchmark::State& state, Fixture& f) {
  for (auto _ : state) {
    manycontact::residual(f.K, f.v);
    benchmark::DoNotOptimize(sparse::componentwise_backward_error(f.v.r, f.v.scale));
  }
}

void solve_whole(benchmark::State& state, Fixture& f) {
  for (auto _ : state) benchmark::DoNotOptimize(solve(f.s.scene, f.s.q, f.s.v, f.s.u, f.data));
}

void rnea_derivatives_whole(benchmark::State& state, Fixture& f) {
  RneaDerivatives d(f.model);
  for (auto _ : state) {
    forward_kinematics<double>(f.model, {}, f.s.q, f.kin);
    forward_accelerations<double>(f.model, f.s.v, f.qdd.data(), f.s.scene.gravity, f.kin);
    f.Yc = f.kin.Y;
    for (int i = f.model.njoints() - 1; i > 0; --i) f.Yc[f.model.joints[i].parent] += f.Yc[i];
    rnea_derivatives<double>(f.model, f.kin, f.Yc, {}, d);
    benchmark::DoNotOptimize(d);
  }
}

void differentiate_whole(benchmark::State& state, Fixture& f) {
  (void)solve(f.s.scene, f.s.q, f.s.v, f.s.u, f.data);
  for (auto _ : state) benchmark::DoNotOptimize(differentiate(f.s.scene, f.data));
}

const Registration registered([] {
  const auto add = [](const char* part, void (*run)(benchmark::State&, Fixture&)) {
    benchmark::RegisterBenchmark((std::string("parts/") + part).c_str(), [=](benchmark::State& s) {
      static Fixture fixture(robots(1));
      run(s, fixture);
    })->Unit(benchmark::kMicrosecond);
  };
  add("ldl_numeric", ldl_numeric);
  add("ldl_scheduled", ldl_scheduled);
  add("forward_kinematics", kinematics);
  add("rnea", rnea_whole);
  add("aba", aba_whole);
  add("crba", crba_alone);
  add("contact_rows", rows);
  add("assemble", assemble_k);
  add("triangular_solve", triangular_solve);
  add("scheduled_solve", scheduled_solve);
  add("residual", residual);
  add("solve", solve_whole);
  add("rnea_derivatives", rnea_derivatives_whole);
  add("derivatives", differentiate_whole);
});

}  // namespace
}  // namespace manycontact::bench
