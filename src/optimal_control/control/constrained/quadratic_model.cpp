#include "quadratic_model.hpp"

#include "../integrators/euler_steps.hpp"
#include "manycontact/control/coupled_direction.hpp"
#include "manycontact/detail/control/couplings.hpp"

namespace manycontact::internal {

namespace {

// Sets the matrices and vectors of an lq::Group of one block from the node's derivatives, except its C and D, which
// fill_nodes sets.
void fill_group(const ActionModelAbstract& model, const ActionDataAbstract& from, bool terminal, Terms terms,
                lq::Group& to) {
  to.q = from.Lx;
  if (terms == Terms::kAll) to.Q = from.Lxx;
  if (terminal) return;
  to.r = from.Lu;
  from.dynamics(to.A, to.B);
  // Adds zero columns for a node with fewer controls than others.
  if (const Eigen::Index u = to.R.cols(), own = to.B.cols(); own < u) {
    to.B.conservativeResize(Eigen::NoChange, u);
    to.B.rightCols(u - own).setZero();
    to.r.conservativeResize(u);
    to.r.tail(u - own).setZero();
  }
  if (terms == Terms::kAll) {
    to.S = from.Lxu;
    to.R = from.Luu;
  }
  const IntegratedActionDataEuler* euler = known_steps(model, from);
  if (!euler) return to.steps.reset();
  if (!to.steps) to.steps.emplace();
  fill_steps(*euler, *to.steps);
}

}  // namespace

const ActionModelParts* as_coupled(const ShootingProblem& problem, std::size_t t) {
  const auto* parts = dynamic_cast<const ActionModelParts*>(problem.model(t).get());
  return parts && parts->get_couplings() ? parts : nullptr;
}

std::vector<ActionPart> blocks_of(const ShootingProblem& problem) {
  std::vector<ActionPart> out;
  if (CoupledDirection::applies_to(problem)) {
    for (const ActionPart& part : as_coupled(problem, problem.get_T())->get_parts())
      out.push_back({nullptr, part.x, part.dx, part.u});
  } else {
    out.push_back(
        {nullptr, {}, range(0, static_cast<int>(problem.get_ndx())), range(0, static_cast<int>(problem.get_nu_max()))});
  }
  return out;
}

lq::Knot knot_of(std::size_t blocks, const std::vector<std::pair<int, int>>& couplings) {
  lq::Knot knot;
  for (std::size_t i = 0; i < blocks; ++i) {
    lq::Group group;
    group.blocks = {static_cast<int>(i)};
    for (std::size_t b = 0; b < couplings.size(); ++b)
      if (couplings[b].first == static_cast<int>(i) || couplings[b].second == static_cast<int>(i))
        group.couplings.push_back(static_cast<int>(b));
    knot.groups.push_back(std::move(group));
  }
  knot.couplings.assign(couplings.size(), {6, 6});
  return knot;
}

lq::Problem structure_of(const ShootingProblem& problem, const std::vector<ActionPart>& blocks) {
  lq::Problem out;
  for (const ActionPart& block : blocks) {
    out.nx.push_back(static_cast<int>(block.dx.size()));
    out.nu.push_back(static_cast<int>(block.u.size()));
  }
  for (std::size_t t = 0; t <= problem.get_T(); ++t) {
    std::vector<std::pair<int, int>> couplings;
    if (const auto* coupled = as_coupled(problem, t); coupled && t < problem.get_T())
      for (const Coupling& coupling : coupled->get_couplings()->couplings())
        couplings.emplace_back(coupling.part_a, coupling.part_b);
    out.knots.push_back(knot_of(blocks.size(), couplings));
  }
  lq::set_zero(out);
  return out;
}

void fill_nodes(const ShootingProblem& problem, Terms terms, lq::Problem& out) {
  const std::size_t T = problem.get_T();
  for (std::size_t t = 0; t <= T; ++t) {
    const ActionModelParts* coupled = as_coupled(problem, t);
    if (!coupled) {
      fill_group(*problem.model(t), *problem.data(t), t == T, terms, out.knots[t].groups[0]);
      continue;
    }
    const auto& data = static_cast<const ActionDataParts&>(*problem.data(t));
    for (std::size_t i = 0; i < data.parts.size(); ++i) {
      lq::Group& group = out.knots[t].groups[i];
      fill_group(*coupled->get_parts()[i].model, *data.parts[i], t == T, terms, group);
      if (t == T) continue;
      group.C = data.couplings->C[i];
      group.D = data.couplings->D[i];
    }
  }
}

}  // namespace manycontact::internal
