#include <algorithm>
#include <cmath>
#include <map>

#include "manycontact/analysis/findings.hpp"
#include "optimize.hpp"
#include "program/text/table.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostTorques = 6;

struct Torque {  // the largest torque of one joint, with the joint's limit and the time of this torque
  std::string name;
  double u = 0, limit = 0, time = 0;
  double share() const { return std::isfinite(limit) && limit > 0 ? std::abs(u) / limit : 0; }
};

struct Bore {  // the normal and tangential forces of a group of contacts over all nodes
  int nodes = 0;
  double least = INFINITY, most = 0;  // least and largest normal force [N]
  double ratio = 0, mu = INFINITY;    // largest tangential/normal force, smallest mu of the cones
};

void add_force(const Eigen::Vector2d& pressure, double mu, Bore& bore) {
  const auto [normal, tangential] = std::pair(pressure[0], pressure[1]);
  ++bore.nodes;
  bore.least = std::min(bore.least, normal);
  bore.most = std::max(bore.most, normal);
  bore.ratio = std::max(bore.ratio, normal > 0 ? tangential / normal : INFINITY);
  bore.mu = std::min(bore.mu, mu);
}

}  // namespace

double friction_of(const TaskPhase& phase, int contact) {
  double mu = INFINITY;
  for (const auto* terms : {&phase.costs, &phase.constraints})
    for (const TaskTerm& term : *terms)
      if (term.mu > 0 && std::ranges::count(term.contacts, contact) > 0) mu = std::min(mu, term.mu);
  return mu;
}

void print_torques(std::ostream& out, const OptimizedTask& motion) {
  const auto& us = motion.solution.us;
  const std::vector<std::string> names = torque_names(motion.task.scene.scene);
  const Eigen::VectorXd& limits = motion.problem.models.front()->get_u_ub();
  std::vector<Torque> list(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    list[i].name = names[i];
    list[i].limit = limits[i];
    for (std::size_t t = 0; t < us.size(); ++t) {
      if (motion.nodes[t].impact) continue;
      const double u = us[t][i];
      if (std::abs(u) > std::abs(list[i].u)) list[i].u = u, list[i].time = motion.nodes[t].time;
    }
  }
  const std::size_t shown = std::min(kMostTorques, list.size());
  std::partial_sort(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(shown), list.end(),
                    [](const Torque& a, const Torque& b) {
                      return std::make_pair(a.share(), std::abs(a.u)) > std::make_pair(b.share(), std::abs(b.u));
                    });
  Table table("largest torques<40|Nm or N|limit|of it|at [s]");
  for (std::size_t i = 0; i < shown; ++i) {
    const Torque& torque = list[i];
    const bool limited = std::isfinite(torque.limit);
    table.add({printable(torque.name), decimal(torque.u, 1), limited ? number(torque.limit) : "none",
               limited ? number(100 * torque.share()) + " %" : "", number(torque.time)});
  }
  if (!table.empty()) table.print(out);
}

void print_forces(std::ostream& out, const OptimizedTask& motion) {
  const TaskFile& task = motion.task;
  std::map<std::size_t, Bore> bores;  // key: contact group
  for (std::size_t t = 0; t + 1 < motion.nodes.size(); ++t) {
    const auto forces = contact_forces(task, motion.problem, t);
    const auto q = motion.solution.xs[t].head(task.scene.scene.nq);
    for (std::size_t g = 0; g < task.scene.contact_groups.size(); ++g) {
      const ContactGroup& group = task.scene.contact_groups[g];
      for (int c = group.first; c < group.first + group.count; ++c)
        if (forces[c].size() >= 3)
          add_force(contact_pressure(task.scene.scene, c, q, forces[c]),
                    friction_of(phase_at(task, motion.nodes[t]), c), bores[g]);
    }
  }
  Table table("contact forces<40|nodes|least normal [N]|most|tangential/normal|cone");
  for (const auto& [g, bore] : bores) {
    const ContactGroup& group = task.scene.contact_groups[g];
    table.add({printable(group.copied ? group.name + " x" + std::to_string(group.count) : group.name),
               std::to_string(bore.nodes / std::max(1, group.count)), decimal(bore.least, 1), decimal(bore.most, 1),
               std::isfinite(bore.ratio) ? number(bore.ratio) : "pulls",
               std::isfinite(bore.mu) ? number(bore.mu) : ""});
  }
  if (!table.empty()) table.print(out);
}

}  // namespace manycontact::cli
