// Our solver, given K alone: manycontact's scheduled L D L^T in the order leaf-to-root. sparse-ldl:DELTA:STEPS
// factorizes K - [0 0; 0 DELTA I] and makes STEPS steps of refinement with the residual of K.

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "manycontact/sparse/panel_kernels.hpp"
#include "solver.hpp"

namespace manycontact::collection {

namespace {

struct SparseLdl : Solver {
  explicit SparseLdl(const System& s) : n(s.size()), steps(s.steps), place(n) {
    std::iota(place.begin(), place.end(), 0);
    std::reverse(place.begin(), place.begin() + s.nv);  // parents come before their children in the island's order
    pattern.n = n;
    std::vector<std::pair<int, int>> entries;
    each_entry(s, [&](int i, int j, double) { entries.emplace_back(i, j); });
    pattern = sparse::make_pattern(n, std::move(entries));
    K.resize(pattern.nonzeros());
    each_entry(s, [&](int i, int j, double value) { K[pattern.slot(std::min(i, j), std::max(i, j))] = value; });
    damped = K;
    for (int i = s.nv; i < n; ++i) damped[pattern.slot(i, i)] -= s.damping;
    symbolic = sparse::ldl_analyze(pattern);
    schedule = sparse::compile_ldl(pattern, symbolic);
    if (!schedule.compiled()) throw std::runtime_error("the schedule is too large");
    Lx.resize(symbolic.nonzeros());
    for (std::vector<double>* of : {&D, &scale, &b, &x, &r}) of->resize(n);
    for (int k = 0; k < n; ++k) b[place[k]] = s.b[k];
  }

  template <class Use>
  void each_entry(const System& s, Use&& use) {
    for (int j = 0; j < n; ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator it(s.lower, j); it; ++it)
        use(place[it.row()], place[j], it.value());
  }

  Eigen::VectorXd solve() override {
    const sparse::PanelKernels& kernels = sparse::panel_kernels();
    kernels.factor(schedule, damped.data(), nullptr, 0, Lx.data(), D.data(), scale.data());
    x = b;
    kernels.solve_vector(schedule, Lx.data(), D.data(), x.data());
    for (int step = 0; step < steps; ++step) {
      kernels.residual_vector(pattern, K.data(), x.data(), b.data(), r.data(), scale.data());
      kernels.solve_vector(schedule, Lx.data(), D.data(), r.data());
      for (int k = 0; k < n; ++k) x[k] += r[k];
    }
    Eigen::VectorXd out(n);
    for (int k = 0; k < n; ++k) out[k] = x[place[k]];
    return out;
  }

  int n, steps;
  std::vector<int> place;  // position of each row of K in the elimination order
  sparse::UpperCsc pattern;
  sparse::LdlSymbolic symbolic;
  sparse::LdlSchedule schedule;
  std::vector<double> K, damped, Lx, D, scale, b, x, r;
};

}  // namespace

std::vector<Kind> sparse_ldl_kinds() {
  return {{"sparse-ldl", "manycontact " MANYCONTACT_VERSION, 0,
           [](const System& s) -> std::unique_ptr<Solver> { return std::make_unique<SparseLdl>(s); }}};
}

}  // namespace manycontact::collection
