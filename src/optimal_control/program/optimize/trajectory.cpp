#include <cmath>

#include "program/simulate/simulate.hpp"
#include "program/view/view.hpp"
#include "optimize.hpp"

namespace manycontact::cli {

namespace {

std::vector<char> flags(const std::vector<bool>& active) { return {active.begin(), active.end()}; }

}  // namespace

void write_trajectory(const OptimizedTask& motion, const std::string& path) {
  const TaskFile& task = motion.task;
  const Scene& scene = task.scene.scene;
  CsvFile csv(path);
  InvariantsData room(scene);
  write_trajectory_header(scene, csv);
  for (std::size_t t = 0; t < motion.nodes.size(); ++t) {
    if (motion.nodes[t].impact) continue;
    const Eigen::VectorXd q = motion.solution.xs[t].head(scene.nq), v = motion.solution.xs[t].tail(scene.nv);
    const Invariants at = invariants(scene, flags(phase_at(task, motion.nodes[t]).active), q, v, room);
    write_trajectory_row(motion.nodes[t].time, q, v, at, csv);
  }
  csv.close();
}

void write_torques(const OptimizedTask& motion, const std::string& path) {
  CsvFile csv(path, "--torques");
  csv << "t";
  for (const std::string& name : torque_names(motion.task.scene.scene)) csv << "u:" + name;
  csv.end_row();
  for (std::size_t t = 0; t < motion.solution.us.size(); ++t) {
    if (motion.nodes[t].impact) continue;
    csv << motion.nodes[t].time;
    for (const double u : motion.solution.us[t]) csv << u;
    csv.end_row();
  }
  csv.close();
}

void write_forces(const OptimizedTask& motion, const std::string& path) {
  const auto& contacts = motion.task.scene.scene.contacts;
  CsvFile csv(path, "--forces");
  write_forces_header(motion.task.scene.scene, csv);
  for (std::size_t t = 0; t < motion.solution.us.size(); ++t) {
    if (motion.nodes[t].impact) continue;
    const std::vector<Eigen::VectorXd> forces = contact_forces(motion.task, motion.problem, t);
    csv << motion.nodes[t].time;
    for (std::size_t c = 0; c < contacts.size(); ++c)
      for (int k = 0; k < contacts[c].rows(); ++k) csv << (forces[c].size() > 0 ? forces[c][k] : 0.0);
    csv.end_row();
  }
  csv.close();
}

void record_motion(const OptimizedTask& motion, Recording& recording) {
  const TaskFile& task = motion.task;
  const Scene& scene = task.scene.scene;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    double mu = INFINITY;
    for (const TaskPhase& phase : task.phases) mu = std::min(mu, friction_of(phase, static_cast<int>(c)));
    recording.friction[c] = std::isfinite(mu) ? mu : scene.contacts[c].mu.value_or(0);
  }
  const TaskSolution& s = motion.solution;
  for (std::size_t t = 0; t < motion.nodes.size(); ++t) {
    if (motion.nodes[t].impact) continue;
    ViewState state{motion.nodes[t].time, s.xs[t].head(scene.nq), s.xs[t].tail(scene.nv),
                    flags(phase_at(task, motion.nodes[t]).active)};
    if (t < s.us.size()) state.u = s.us[t];  // the terminal node has no torques or forces
    add_state(state, recording);
  }
}

}  // namespace manycontact::cli
