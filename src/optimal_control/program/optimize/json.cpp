#include "program/files/json_file.hpp"
#include "optimize.hpp"

namespace manycontact::cli {

namespace {

Json iterations(const TaskSolution& s) {
  Json list = Json::array();
  for (const TaskIteration& i : s.iterations)
    list.push_back({{"cost", i.cost},
                    {"stop", i.stop},
                    {"regularisation", i.regularisation},
                    {"step_length", i.step_length},
                    {"gaps", i.gaps},
                    {"feasible", i.feasible}});
  return list;
}

Json constraints(const TaskSolution& s) {
  Json list = Json::array();
  for (const TaskViolation& v : s.violations)
    list.push_back({{"name", v.constraint}, {"violation", v.by}, {"node", v.node}});
  return list;
}

Json costs(const OptimizedTask& motion) {
  Json list = Json::array();
  for (const PlanCost& cost : motion.costs) {
    list.push_back({{"name", cost.name}, {"type", to_string(cost.residual)}, {"cost", cost.cost}});
    if (cost.is_goal) list.back()["missed"] = cost.missed, list.back()["node"] = cost.node;
  }
  return list;
}

Json findings(const OptimizedTask& motion) {
  Json list = Json::array();
  for (const PlanFinding& f : motion.findings)
    list.push_back({{"kind", f.kind}, {"name", f.name}, {"node", f.node}, {"text", f.text}});
  return list;
}

Json report(const OptimizedTask& motion) {
  const TaskSolution& s = motion.solution;
  const TaskTimes& t = s.times;
  Json out = {
      {"solver", s.solver},
      {"direction", s.direction},
      {"blocks", s.blocks},
      {"kkt_residual", s.kkt_residual},
      {"polishing_iterations", s.polishing_iterations},
      {"constraint_violation", s.constraint_violation},
      {"constraints", constraints(s)},
      {"outer_iterations", s.outer_iterations},
      {"remarks", s.remarks},
      {"cost_by_term", costs(motion)},
      {"time_us", {{"calc", t.calc}, {"calc_diff", t.calc_diff}, {"direction", t.direction}, {"total", t.total}}},
  };
  if (const auto& simulation = motion.simulation)
    out["simulation"] = {{"completed", simulation->stopped == StepStatus::kOk},
                         {"violation_position", simulation->violation_position},
                         {"violation_velocity", simulation->violation_velocity},
                         {"energy_lost", simulation->energy_lost},
                         {"distance", simulation->distance}};
  return out;
}

}  // namespace

void write_json(const OptimizedTask& motion, const std::string& path) {
  const TaskSolution& s = motion.solution;
  write_json_file({{"task", motion.task.name},
                   {"converged", s.converged},
                   {"cost", s.cost},
                   {"reason", s.reason},
                   {"findings", findings(motion)},
                   {"iterations", iterations(s)},
                   {"xs", json_of(s.xs)},
                   {"us", json_of(s.us)},
                   {"report", report(motion)}},
                  path);
}

}  // namespace manycontact::cli
