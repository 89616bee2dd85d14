#include "manycontact/task/joined.hpp"

#include <algorithm>

#include "manycontact/control/coupled_direction.hpp"
#include "manycontact/detail/control/couplings.hpp"
#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/task/parts.hpp"
#include "nodes.hpp"

namespace manycontact {

namespace {

// Returns whether a term requires that all its robots are in one block.
bool joins_its_robots(const TaskTerm& term) {
  switch (term.residual) {
    case TaskResidual::kJointEffort:
    case TaskResidual::kControlGrav:
    case TaskResidual::kContactControlGrav:
      return true;
    case TaskResidual::kCom:
    case TaskResidual::kCentroidalMomentum:
      return term.robots.empty();
    default:
      return false;
  }
}

}  // namespace

int task::dependent_rows(Scene scene, const Eigen::VectorXd& x0) {
  scene.damping = 0;
  SceneData data(scene);
  const Report& report = solve(scene, x0.head(scene.nq), x0.tail(scene.nv), Eigen::VectorXd::Zero(scene.nu), data);
  return report.nc - report.rank;
}

std::vector<std::vector<int>> divide_robots(const TaskFile& task) {
  const Scene& scene = task.scene.scene;
  const bool impacts =
      std::any_of(task.phases.begin(), task.phases.end(), [](const TaskPhase& phase) { return phase.impact; });
  return sets_of_robots(task, [&](const TaskPhase& phase, sparse::UnionFind& sets) {
    if (task.integrator != TaskIntegrator::kEuler || impacts) join_robots(scene, {}, sets);
    for (std::size_t c = 0; c < scene.contacts.size(); ++c)
      if (phase.active[c] && !joins_robots(scene.contacts[c])) join_ends(scene.contacts[c], sets);
    for (const auto* terms : {&phase.costs, &phase.constraints})
      for (const TaskTerm& term : *terms) {
        if (joins_its_robots(term))
          join_robots(scene, term.residual == TaskResidual::kJointEffort ? term.robots : std::vector<int>{}, sets);
        for (const int c : term.contacts) join_ends(scene.contacts[c], sets);
      }
  });
}

bool blocks_are_cheaper(const TaskFile& task, const std::vector<std::vector<int>>& blocks) {
  const Scene& scene = task.scene.scene;
  std::vector<int> nx, nu;
  for (const std::vector<int>& robots : blocks) {
    const ActionPart at = coordinates_of(scene, robots);
    nx.push_back(static_cast<int>(at.dx.size()));
    nu.push_back(static_cast<int>(at.u.size()));
  }
  std::vector<std::vector<std::pair<int, int>>> couplings;
  for (const TaskPhase& phase : task.phases) {
    std::vector<std::pair<int, int>> of_phase;
    for (const Coupling& coupling : couplings_between(task::scene_with(task, phase.active), blocks))
      of_phase.emplace_back(coupling.part_a, coupling.part_b);
    couplings.insert(couplings.end(), static_cast<std::size_t>(phase.nodes), of_phase);
  }
  const CoupledPrediction flops = predict_coupled(nx, nu, couplings);
  return flops.coupled < flops.dense;
}

bool couplings_are_independent(const TaskFile& task, const std::vector<std::vector<int>>& blocks) {
  const Eigen::VectorXd x0 = task::x0_of(task.scene);
  for (const TaskPhase& phase : task.phases) {
    Scene scene = task::scene_with(task, phase.active);
    const int of_all = task::dependent_rows(scene, x0);
    if (of_all == 0) continue;
    for (const Coupling& coupling : couplings_between(scene, blocks)) scene.contacts[coupling.contact].active = false;
    if (task::dependent_rows(scene, x0) != of_all) return false;
  }
  return true;
}

namespace task {

namespace {

// Makes the node of one block of robots in a phase, with the wrenches of couplings as additional controls.
std::shared_ptr<ActionModelAbstract> block_of(const TaskFile& own, const TaskPhase& phase,
                                              const std::vector<WrenchEnd>& ends, bool terminal) {
  auto state = std::make_shared<StateMultibody>(own.scene.scene);
  auto actuation = std::make_shared<ActuationModelWrenches>(state, actuation_of(state), ends);
  const auto model = model_of(own, phase, state, actuation, MatrixStorage::kDense);
  return terminal ? terminal_of(model) : integrated(own, model);
}

}  // namespace

Nodes joined_nodes(const TaskFile& task, const std::vector<std::vector<int>>& groups) {
  const auto state = std::make_shared<StateMultibody>(task.scene.scene);
  std::vector<TaskFile> own;
  for (const std::vector<int>& robots : groups) own.push_back(part_of(task, robots));
  Nodes out;
  for (std::size_t k = 0; k <= task.phases.size(); ++k) {
    const bool terminal = k == task.phases.size();
    const TaskPhase& phase = terminal ? task.terminal : task.phases[k];
    Scene scene = task::scene_in(task, phase);
    for (Contact& contact : scene.contacts) contact.active = contact.active && !terminal;
    for (std::size_t c = 0; c < scene.contacts.size(); ++c)
      if (phase.active[c] && task::holds_where_it_closed(task, phase, c)) scene.contacts[c].alpha = 0;
    const std::vector<Coupling> couplings = couplings_between(scene, groups);
    std::vector<ActionPart> parts;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      parts.push_back(coordinates_of(task.scene.scene, groups[i]));
      parts.back().model = block_of(own[i], terminal ? own[i].terminal : own[i].phases[k],
                                    wrench_ends(scene, couplings, groups, static_cast<int>(i)), terminal);
      parts.back().robots = groups[i];
    }
    auto node = std::make_shared<ActionModelParts>(state, scene, std::move(parts));
    node->set_storage(MatrixStorage::kSparse);
    if (terminal)
      out.terminal = std::move(node);
    else
      out.phases.push_back(std::move(node));
  }
  out.impacts.resize(out.phases.size());  // no impacts: see divide_robots
  return out;
}

}  // namespace task

}  // namespace manycontact
