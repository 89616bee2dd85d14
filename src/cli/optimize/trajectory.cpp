#include "../simulate/simulate.hpp"
#include "optimize.hpp"

namespace manycontact::cli {

namespace {

std::vector<char> flags(const std::vector<bool>& active) { return {active.begin(), active.end()}; }

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
    const TaskPhase& phase = t < phases.size() ? task.phases[static_cast<std::size_t>(phases[t])] : task.terminal;
    const Invariants at = invariants(scene, flags(phase.active), q, v, room);
    write_trajectory_row(task.step * static_cast<double>(t), q, v, at, csv);
  }
  csv.close();
}

}  // namespace manycontact::cli
