// Draws convergence, torques with limits, and forces with cones for `manycontact optimize`. Python reads them as JSON.

#include <cmath>
#include <filesystem>

#include "program/files/json_file.hpp"
#include "program/files/python.hpp"
#include "manycontact/analysis/findings.hpp"
#include "optimize.hpp"

namespace manycontact::cli {

namespace {

// Returns the nodes that have torques and are not impacts.
std::vector<std::size_t> nodes_with_torques(const OptimizedTask& motion) {
  std::vector<std::size_t> with;
  for (std::size_t t = 0; t + 1 < motion.nodes.size() && t < motion.solution.us.size(); ++t)
    if (!motion.nodes[t].impact) with.push_back(t);
  return with;
}

Json convergence(const OptimizedTask& motion) {
  Json out = Json::array();
  for (const TaskIteration& i : motion.solution.iterations)
    out.push_back({{"cost", i.cost}, {"stop", i.stop}, {"gaps", i.gaps}});
  return out;
}

Json torques(const OptimizedTask& motion) {
  const Eigen::VectorXd& limits = motion.problem.models.front()->get_u_ub();
  const std::vector<std::string> names = torque_names(motion.task.scene.scene);
  Json out = Json::array();
  for (Eigen::Index i = 0; i < limits.size(); ++i) {
    std::vector<double> values;
    for (std::size_t t : nodes_with_torques(motion)) values.push_back(motion.solution.us[t][i]);
    out.push_back({{"name", names[i]}, {"limit", limits[i]}, {"values", values}});
  }
  return out;
}

// Writes normal and tangential forces of contacts with at least three rows, and their cones' smallest mu.
void add_forces(const OptimizedTask& motion, Json& out) {
  const Scene& scene = motion.task.scene.scene;
  std::vector<std::vector<double>> normal(scene.contacts.size()), tangential(scene.contacts.size());
  std::vector<double> mu(scene.contacts.size(), INFINITY);
  for (std::size_t t : nodes_with_torques(motion)) {
    const auto forces = contact_forces(motion.task, motion.problem, t);
    const auto q = motion.solution.xs[t].head(scene.nq);
    for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
      const bool bears = forces[c].size() >= 3;
      const int contact = static_cast<int>(c);
      const Eigen::Vector2d p = bears ? contact_pressure(scene, contact, q, forces[c]) : Eigen::Vector2d(NAN, NAN);
      normal[c].push_back(p[0]);
      tangential[c].push_back(p[1]);
      if (bears) mu[c] = std::min(mu[c], friction_of(phase_at(motion.task, motion.nodes[t]), contact));
    }
  }
  out["smallest_mu"] = mu.empty() ? INFINITY : *std::ranges::min_element(mu);
  out["contacts"] = Json::array();
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    out["contacts"].push_back({{"name", scene.contacts[c].name},
                               {"mu", mu[c]},
                               {"normal", normal[c]},
                               {"tangential", tangential[c]}});
}

}  // namespace

void draw_charts(const OptimizedTask& motion, const std::string& folder) {
  Json out{{"task", motion.task.name},           {"reason", motion.solution.reason},  {"step_s", motion.task.step},
           {"tolerance", motion.task.tolerance}, {"iterations", convergence(motion)}, {"torques", torques(motion)}};
  add_forces(motion, out);
  write_json_file(out, (std::filesystem::path(folder) / "charts.json").string(), "--charts");
  run_python(find_python(), script_path("motion.py"), {folder});
}

}  // namespace manycontact::cli
