#include "manycontact/lq/choose.hpp"

#include "manycontact/lq/bond_schur.hpp"

namespace manycontact::lq {

Prediction predict(const Problem& problem) {
  const Plan no_bonds = make_plan(problem, Join::kNoBonds);
  return {riccati_flops(problem, make_plan(problem, Join::kAll)),
          riccati_flops(problem, make_plan(problem, Join::kIslands)),
          bond_schur_flops(problem, no_bonds, make_bond_graph(problem, no_bonds))};
}

std::unique_ptr<DirectionSolver> choose(const Problem& problem) {
  check(problem);
  bool terminal_rows = false;
  for (const Bond& bond : problem.knots.back().bonds) terminal_rows |= bond.rows > bond.size;
  const Prediction flops = predict(problem);
  std::unique_ptr<DirectionSolver> solver;
  if (terminal_rows || flops.bond_schur < flops.islands)
    solver = std::make_unique<BondSchur>();
  else
    solver = std::make_unique<Riccati>(Join::kIslands);
  solver->analyse(problem);
  return solver;
}

}  // namespace manycontact::lq
