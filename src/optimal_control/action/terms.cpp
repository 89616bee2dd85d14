#include "terms.hpp"

namespace manycontact::internal {

void check_terms(const char* where, const ActionTerms& terms, const CostDataSum& costs,
                 const ConstraintDataManager* constraints) {
  require(costs.version == terms.costs.get_version(), where,
          "costs were added or removed since the data were created, new data are expected");
  if (!terms.constraints) return;
  require(constraints->version == terms.constraints->get_version(), where,
          "constraints were added or removed since the data were created, new data are expected");
  for (const auto& [name, item] : terms.constraints->get_constraints())
    require(item->active == terms.constraints->get_active_set().contains(name), where,
            "the status of a constraint was changed in the item, call changeConstraintStatus instead");
}

bool residuals_fit(const ActionTerms& terms, const CostDataSum& costs, const ConstraintDataManager* constraints) {
  auto cost = costs.costs.begin();
  for (const auto& [name, item] : terms.costs.get_costs())
    if (!item->cost->get_residual()->fits(*(cost++)->second->residual)) return false;
  if (!terms.constraints) return true;
  auto constraint = constraints->constraints.begin();
  for (const auto& [name, item] : terms.constraints->get_constraints())
    if (!item->constraint->get_residual()->fits(*(constraint++)->second)) return false;
  return true;
}

void read_status(const ActionTerms& terms, std::vector<bool>& status) {
  status.clear();
  each_residual(terms, [&](const auto&, const auto&, bool active) { status.push_back(active); });
}

bool has_status(const ActionTerms& terms, const std::vector<bool>& status) {
  std::size_t k = 0;
  bool same = true;
  each_residual(terms, [&](const auto&, const auto&, bool active) {
    same = same && k < status.size() && status[k] == active;
    ++k;
  });
  return same && k == status.size();
}

void check_stage(const char* who, bool fits, Stage stage) {
  if (fits) return;
  throw std::logic_error(std::string(who) + "::calcDiff: calcDiff uses the values of the last calc; call " +
                         (stage == Stage::kRunning ? "calc(data, x, u)" : "calc(data, x)") +
                         " before calcDiff, with the same data, costs and constraints");
}

void stack_residuals(const CostModelSum& model, const CostDataSum& data, Eigen::VectorXd& r) {
  Eigen::Index nr = 0;
  for (const auto& [name, item] : model.get_costs())
    if (item->active) nr += item->cost->get_residual()->get_nr();
  r.resize(nr);
  Eigen::Index at = 0;
  auto part = data.costs.begin();
  for (const auto& [name, item] : model.get_costs()) {
    const Eigen::VectorXd& of_cost = (part++)->second->residual->r;
    if (!item->active) continue;
    r.segment(at, of_cost.size()) = of_cost;
    at += of_cost.size();
  }
}

}  // namespace manycontact::internal
