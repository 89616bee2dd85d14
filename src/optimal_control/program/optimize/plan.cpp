#include <algorithm>

#include "optimize.hpp"
#include "program/text/table.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostCosts = 12, kMostFindings = 6;  // most costs, and most findings of a kind, in the summary

// Prints the findings of one kind, for example "closes: LF ...; LH ...; and 3 more".
void print_kind(std::ostream& out, const std::string& title, const std::vector<const PlanFinding*>& findings) {
  std::vector<std::string> texts;
  for (const PlanFinding* finding : findings) texts.push_back(printable(finding->name) + " " + finding->text);
  wrap(out, join(texts, kMostFindings, "; ", "; and "), 2, title + ": ");
}

}  // namespace

void print_costs(std::ostream& out, const OptimizedTask& motion) {
  Table table("costs<40|type<|cost|of all|missed by|at node");
  for (std::size_t k = 0; k < std::min(kMostCosts, motion.costs.size()); ++k) {
    const PlanCost& cost = motion.costs[k];
    table.add({printable(cost.name), to_string(cost.residual), number(cost.cost, 4),
               motion.solution.cost > 0 ? number(100 * cost.cost / motion.solution.cost) + " %" : "",
               cost.is_goal ? number(cost.missed) : "", cost.is_goal ? std::to_string(cost.node) : ""});
  }
  if (table.empty()) return;
  table.print(out);
  if (motion.costs.size() > kMostCosts) out << "  and " << motion.costs.size() - kMostCosts << " smaller costs\n";
}

void print_plan_findings(std::ostream& out, const OptimizedTask& motion) {
  if (motion.findings.empty()) return;
  out << "\nWarnings\n";
  const std::pair<const char*, const char*> titles[] = {{"no_inertia", "joints without inertia"},
                                                        {"failed", "the dynamics fail"},
                                                        {"closes", "out of place"},
                                                        {"position", "beyond position limits"},
                                                        {"velocity", "beyond velocity limits"},
                                                        {"effort", "beyond efforts"},
                                                        {"goal", "goals missed"},
                                                        {"guess", "guess not at rest"},
                                                        {"near_dependent", "nearly dependent"}};
  for (const auto& [kind, title] : titles) {
    std::vector<const PlanFinding*> alike;
    for (const PlanFinding& f : motion.findings)
      if (f.kind == kind) alike.push_back(&f);
    if (!alike.empty()) print_kind(out, title, alike);
  }
  out << "\n";
}

}  // namespace manycontact::cli
