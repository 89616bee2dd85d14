#include <cmath>

#include "../simulate/simulate.hpp"
#include "../view/view.hpp"
#include "optimize.hpp"

namespace manycontact::cli {

namespace {

std::vector<char> flags(const std::vector<bool>& active) { return {active.begin(), active.end()}; }

const TaskPhase& phase_at(const TaskFile& task, const std::vector<int>& phases, std::size_t t) {
  return t < phases.size() ? task.phases[static_cast<std::size_t>(phases[t])] : task.terminal;
}

}  // namespace

void write_trajectory(const OptimizedTask& motion, const std::string& path) {
  const TaskFile& task = motion.task;
  const Scene& scene = task.scene.scene;
  const std::vector<int> phases = phase_of_node(task);
  CsvFile csv(path);
  InvariantsData room(scene);
  write_trajectory_header(scene, csv);
  for (std::size_t t = 0; t < motion.solution.xs.size(); ++t) {
    const Eigen::VectorXd q = motion.solution.xs[t].head(scene.nq), v = motion.solution.xs[t].tail(scene.nv);
    const Invariants at = invariants(scene, flags(phase_at(task, phases, t).active), q, v, room);
    write_trajectory_row(task.step * static_cast<double>(t), q, v, at, csv);
  }
  csv.close();
}

void record_motion(const OptimizedTask& motion, Recording& recording) {
  const TaskFile& task = motion.task;
  const Scene& scene = task.scene.scene;
  const std::vector<int> phases = phase_of_node(task);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    double mu = INFINITY;
    for (const TaskPhase& phase : task.phases) mu = std::min(mu, friction_of(phase, static_cast<int>(c)));
    recording.friction[c] = std::isfinite(mu) ? mu : scene.contacts[c].mu.value_or(0);
  }
  const TaskSolution& s = motion.solution;
  for (std::size_t t = 0; t < s.xs.size(); ++t) {
    ViewState state{task.step * static_cast<double>(t), s.xs[t].head(scene.nq), s.xs[t].tail(scene.nv),
                    flags(phase_at(task, phases, t).active)};
    if (t < s.us.size()) state.u = s.us[t];  // the terminal node has no torques, and so no forces
    add_state(state, recording);
  }
}

}  // namespace manycontact::cli
