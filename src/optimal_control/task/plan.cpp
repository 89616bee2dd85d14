#include "manycontact/task/plan.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "manycontact/analysis/near_dependent.hpp"
#include "manycontact/analysis/text.hpp"
#include "manycontact/control/integrated_action.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/detail/control/parts.hpp"
#include "nodes.hpp"

namespace manycontact {

namespace {

constexpr double kOutOfPlace = 1e-3;  // smallest error [m, rad] that is reported

using Vectors = std::vector<Eigen::VectorXd>;

struct Point {  // position and velocity of a point of a robot, or of the world
  Vec3<double> p = Vec3<double>::Zero(), v = Vec3<double>::Zero();
};

Point point_at(const Scene& scene, const Attachment& at, const Eigen::VectorXd& x) {
  Point out;
  if (at.robot < 0) {
    out.p = at.placement.p;
    return out;
  }
  const Robot& robot = scene.robots[at.robot];
  Kinematics<double> kin(*robot.model);
  forward_kinematics<double>(*robot.model, robot.base, x.segment(robot.idx_q, robot.model->nq), kin);
  out.p = frame_placement<double>(kin, robot.base, at.joint, at.placement).p;
  if (at.joint < 0) return out;
  const Eigen::VectorXd v = x.segment(scene.nq + robot.idx_v, robot.model->nv);
  forward_accelerations<double>(*robot.model, v, nullptr, scene.gravity, kin);
  out.v = frame_velocity<double>(kin, robot.base, at.joint, at.placement, ReferenceFrame::kLocalWorldAligned).head<3>();
  return out;
}

PlanClosing closing_of(const Scene& scene, int c, const Eigen::VectorXd& x) {
  const Contact& contact = scene.contacts[c];
  const Point A = point_at(scene, contact.A, x), B = point_at(scene, contact.B, x);
  const Vec3<double> e = A.p - B.p;
  PlanClosing out;
  out.contact = c;
  out.speed = (A.v - B.v).norm();
  out.above = contact.B.robot < 0 ? e.z() : e.norm();
  out.aside = contact.B.robot < 0 ? e.head<2>().norm() : 0;
  return out;
}

bool is_goal(TaskResidual residual) {
  return residual == TaskResidual::kFramePlacement || residual == TaskResidual::kFrameTranslation ||
         residual == TaskResidual::kFrameRotation || residual == TaskResidual::kCom;
}

using ByName = std::map<std::string, PlanCost>;

// Maps the name of each cost in the problem to its term. A term of several robots is several named costs.
std::map<std::string, const TaskTerm*> terms_by_item(const TaskFile& task) {
  std::map<std::string, const TaskTerm*> out;
  const auto add = [&](const TaskPhase& phase) {
    for (const TaskTerm& term : phase.costs) {
      out[term.name] = &term;
      const std::size_t copies = std::max(term.robots.size(), term.contacts.size());
      for (std::size_t i = 0; copies > 1 && i < copies; ++i) out[term.name + std::to_string(i)] = &term;
    }
  };
  for (const TaskPhase& phase : task.phases) add(phase);
  add(task.terminal);
  return out;
}

struct Adder {
  const std::map<std::string, const TaskTerm*>& terms;
  ByName& out;
  std::size_t t = 0;
  bool terminal = false;

  void dynamics(const DifferentialActionModelAbstract& model, const DifferentialActionDataAbstract& data, double weight,
                bool looks) {
    const auto& own = dynamic_cast<const DifferentialActionModelContactFwdDynamics&>(model);
    const CostDataSum& costs = *dynamic_cast<const DifferentialActionDataContactFwdDynamics&>(data).costs;
    for (const auto& [name, item] : own.get_costs()->get_costs()) {
      if (!item->active) continue;
      const CostDataAbstract& cost = *costs.costs.at(name);
      const TaskTerm& term = *terms.at(name);
      PlanCost& sum =
          out.try_emplace(term.name, PlanCost{term.name, term.residual, 0, is_goal(term.residual), 0, t}).first->second;
      sum.cost += weight * item->weight * cost.cost;
      if (!looks) continue;
      if (sum.node != t) sum.node = t, sum.missed = 0;
      sum.missed = std::max(sum.missed, cost.residual->r.norm());
    }
  }

  void node(const ActionModelAbstract& model, const ActionDataAbstract& data) {
    if (const auto* whole = dynamic_cast<const ActionModelParts*>(&model)) {
      const auto& parts = static_cast<const ActionDataParts&>(data).parts;
      for (std::size_t i = 0; i < parts.size(); ++i) node(*whole->get_parts()[i].model, *parts[i]);
    } else if (const auto* own = dynamic_cast<const IntegratedActionModelAbstract*>(&model)) {
      const auto& stages = dynamic_cast<const IntegratedActionDataAbstract&>(data);
      for (std::size_t i = 0; i < (terminal ? 1 : stages.stages()); ++i)
        dynamics(*own->get_differential(), *stages.stage(i).differential,
                 terminal ? 1 : own->get_dt() * own->get_weight(i), i == 0);
    }
  }
};

std::string show(double x, int digits = 3) {
  std::ostringstream out;
  out << std::setprecision(digits) << x;
  return out.str();
}

PlanFinding in_words(const TaskFile& task, const PlanClosing& c) {
  const Contact& contact = task.scene.scene.contacts[c.contact];
  std::string text = "closes at " + show(c.time) + " s, ";
  if (contact.B.robot >= 0)
    text += show(c.above) + " m from its placement in the scene";
  else
    text += show(std::abs(c.above)) + " m " + (c.above > 0 ? "above" : "below") + " its placement in the scene" +
            (c.aside >= kOutOfPlace ? " and " + show(c.aside) + " m aside" : "");
  return {"closes", contact.name, text + ", with a speed of " + show(c.speed) + " m/s", c.node};
}

// Adds findings about nearly dependent contact rows, at the first node with each set of active contacts.
void add_near_dependent(const TaskFile& task, const Vectors& xs, const Vectors& us, std::vector<PlanFinding>& out) {
  const Scene& scene = task.scene.scene;
  const std::vector<TaskNode> nodes = timeline(task);
  std::set<std::vector<char>> judged;
  for (std::size_t t = 0; t < us.size(); ++t) {
    const std::vector<bool>& of_phase = phase_at(task, nodes[t]).active;
    const std::vector<char> active(of_phase.begin(), of_phase.end());
    if (us[t].size() != scene.nu || !xs[t].allFinite() || !judged.insert(active).second) continue;
    SceneData data(scene);
    data.active = active;
    if (solve(scene, xs[t].head(scene.nq), xs[t].tail(scene.nv), us[t], data).status == Status::kFailed) continue;
    for (const NearDependent& n : near_dependent(scene, xs[t].head(scene.nq), data)) {
      std::vector<std::string> rows;
      for (const int row : n.rows) rows.push_back(force_names(scene, data)[row]);
      out.push_back(
          {"near_dependent", text::join(rows, 4), "at " + show(nodes[t].time) + " s: " + in_words(scene, n), t});
    }
  }
}

}  // namespace

std::vector<PlanClosing> closings(const TaskFile& task, const Vectors& xs) {
  std::vector<PlanClosing> out;
  const std::vector<TaskNode> nodes = timeline(task);
  for (std::size_t t = 1; t < nodes.size(); ++t) {
    if (nodes[t].phase == nodes[t - 1].phase) continue;
    const TaskPhase &now = phase_at(task, nodes[t]), &before = phase_at(task, nodes[t - 1]);
    for (std::size_t c = 0; c < now.active.size(); ++c) {
      if (!now.active[c] || before.active[c]) continue;
      out.push_back(closing_of(task.scene.scene, static_cast<int>(c), xs[t]));
      out.back().node = t;
      out.back().time = nodes[t].time;
      out.back().holds_there = !now.at_scene;
    }
  }
  return out;
}

std::vector<PlanLimit> limits_passed(const TaskFile& task, const Vectors& xs, const Vectors& us) {
  const Scene& scene = task.scene.scene;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(scene.nu);
  std::map<std::tuple<int, int, LimitKind>, PlanLimit> worst;
  const auto beyond = [](const LimitPassed& l) { return std::abs(l.value - l.limit); };
  for (std::size_t t = 0; t < xs.size(); ++t) {
    const bool driven = t < us.size() && us[t].size() == none.size();
    for (const LimitPassed& own :
         limits_passed(scene, xs[t].head(scene.nq), xs[t].tail(scene.nv), driven ? us[t] : none)) {
      PlanLimit& known = worst.try_emplace({own.robot, own.dof, own.quantity}, PlanLimit{own, t}).first->second;
      if (beyond(own) > beyond(known.limit)) known = {own, t};
    }
  }
  std::vector<PlanLimit> out;
  for (const auto& [key, limit] : worst) out.push_back(limit);
  return out;
}

std::vector<PlanCost> cost_by_term(const TaskFile& task, const TaskProblem& problem) {
  const ShootingProblem& shooting = *problem.problem;
  const auto terms = terms_by_item(task);
  ByName sums;
  Adder adder{terms, sums};
  for (std::size_t t = 0; t <= shooting.get_T(); ++t) {
    adder.t = t;
    adder.terminal = t == shooting.get_T();
    adder.node(*shooting.model(t), *shooting.data(t));
  }
  std::vector<PlanCost> out;
  for (auto& [name, cost] : sums) out.push_back(std::move(cost));
  std::stable_sort(out.begin(), out.end(), [](const PlanCost& a, const PlanCost& b) { return a.cost > b.cost; });
  return out;
}

std::vector<PlanFinding> plan_findings(const TaskFile& task, const TaskSolution& s,
                                       const std::vector<PlanCost>& costs) {
  const Scene& scene = task.scene.scene;
  const std::vector<TaskNode> nodes = timeline(task);
  std::vector<PlanFinding> out;
  for (const TaskFailure& f : s.failures)
    out.push_back({f.kind, f.name, "at " + show(nodes[f.node].time) + " s: " + f.text, f.node});
  for (const PlanClosing& c : closings(task, s.xs))
    if (std::abs(c.above) >= kOutOfPlace || (!c.holds_there && c.aside >= kOutOfPlace))
      out.push_back(in_words(task, c));
  for (const PlanLimit& own : limits_passed(task, s.xs, s.us)) {
    const LimitPassed& l = own.limit;
    const Robot& robot = scene.robots[l.robot];
    out.push_back({to_string(l.quantity), robot.name + "/" + dof_name(*robot.model, l.dof),
                   to_string(l.quantity) + " " + show(l.value, 4) + ", limit " + show(l.limit, 4) + ", at " +
                       show(nodes[own.node].time) + " s",
                   own.node});
  }
  for (const PlanCost& cost : costs)
    if (cost.is_goal && cost.missed >= kOutOfPlace)
      out.push_back({"goal", cost.name,
                     "is missed by " + show(cost.missed) +
                         (cost.residual == TaskResidual::kFrameRotation ? " rad" : " m") +
                         (cost.residual == TaskResidual::kFramePlacement ? " and rad" : "") + " at " +
                         show(nodes[cost.node].time) + " s",
                     cost.node});
  add_near_dependent(task, s.xs, s.us, out);
  return out;
}

std::vector<PlanFinding> guess_findings(const TaskFile& task) {
  std::vector<PlanFinding> out;
  if (task.guess != TaskGuess::kQuasiStatic || task.scene.scene.nu == 0) return out;
  std::size_t node = 0;
  for (std::size_t k = 0; k < task.phases.size(); ++k) {
    const TaskPhase& phase = task.phases[k];
    const Scene scene = task::scene_in(task, phase);
    std::vector<Unbalanced> unbalanced;
    (void)quasi_static(scene, task.scene.q, &unbalanced);
    for (const Unbalanced& x : unbalanced)
      out.push_back({"guess", name_of(scene, x), "in phase " + std::to_string(k + 1) + ": " + in_words(x), node});
    node += static_cast<std::size_t>(phase.nodes) + (phase.impact ? 1 : 0);
  }
  return out;
}

}  // namespace manycontact
