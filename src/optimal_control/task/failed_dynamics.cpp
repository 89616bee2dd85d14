#include "manycontact/analysis/findings.hpp"
#include "manycontact/control/impulse_fwddyn.hpp"
#include "manycontact/control/integrated_action.hpp"
#include "manycontact/detail/control/parts.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/task/violations.hpp"

namespace manycontact {

namespace {

std::string robots_of(const Scene& scene, const Island& island) {
  std::string out;
  for (const int r : island.robots) out += (out.empty() ? "" : ", ") + scene.robots[r].name;
  return out;
}

void add_dynamics(std::size_t t, const DifferentialActionDataAbstract& data, std::vector<TaskFailure>& out) {
  const auto& own = dynamic_cast<const DifferentialActionDataContactFwdDynamics&>(data);
  const Scene& scene = own.multibody->scene;
  const SceneData& solution = own.multibody->solution;
  const std::vector<IslandReport>& islands = solution.report.islands;
  bool fails = false;
  for (std::size_t i = 0; i < islands.size(); ++i) {
    if (islands[i].status != Status::kFailed) continue;
    fails = true;
    if (islands[i].reason != Reason::kSingularInertia)
      out.push_back({t, "failed", robots_of(scene, solved_island(solution, i)), to_string(islands[i].reason)});
  }
  if (!fails) return;
  for (const MasslessJoint& joint : massless_joints(scene, solution, own.x.head(scene.nq)))
    out.push_back({t, "no_inertia", joint.joint, joint.why});
}

void add_node(std::size_t t, const ActionDataAbstract& data, std::vector<TaskFailure>& out) {
  if (const auto* whole = dynamic_cast<const ActionDataParts*>(&data)) {
    for (const auto& part : whole->parts) add_node(t, *part, out);
  } else if (const auto* own = dynamic_cast<const IntegratedActionDataAbstract*>(&data)) {
    for (std::size_t i = 0; i < own->stages() && (i == 0 || out.empty()); ++i)
      add_dynamics(t, *own->stage(i).differential, out);
  } else if (const auto* impact = dynamic_cast<const ActionDataImpulseFwdDynamics*>(&data)) {
    add_dynamics(t, *impact->dynamics, out);
  }
}

}  // namespace

std::vector<TaskFailure> failed_dynamics(const TaskProblem& problem) {
  std::vector<TaskFailure> out;
  for (std::size_t t = 0; t <= problem.problem->get_T() && out.empty(); ++t)
    add_node(t, *problem.problem->data(t), out);
  return out;
}

}  // namespace manycontact
