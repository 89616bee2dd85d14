#include "manycontact/lq/choose.hpp"

#include "manycontact/lq/coupling_schur.hpp"

namespace manycontact::lq {

Prediction predict(const Problem& problem) {
  const Plan no_couplings = make_plan(problem, Join::kNoCouplings);
  return {riccati_flops(problem, make_plan(problem, Join::kAll)),
          riccati_flops(problem, make_plan(problem, Join::kIslands)),
          coupling_schur_flops(problem, no_couplings, make_coupling_graph(problem, no_couplings))};
}

std::unique_ptr<DirectionSolver> choose(const Problem& problem) {
  check(problem);
  bool terminal_rows = false;
  for (const Coupling& coupling : problem.knots.back().couplings) terminal_rows |= coupling.rows > coupling.size;
  const Prediction flops = predict(problem);
  std::unique_ptr<DirectionSolver> solver;
  if (terminal_rows || flops.coupling_schur < flops.islands)
    solver = std::make_unique<CouplingSchur>();
  else
    solver = std::make_unique<Riccati>(Join::kIslands);
  solver->analyse(problem);
  return solver;
}

}  // namespace manycontact::lq
