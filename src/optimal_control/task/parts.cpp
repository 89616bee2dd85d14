#include "manycontact/task/parts.hpp"

#include "manycontact/detail/model/inputs.hpp"

namespace manycontact {

namespace {

bool joins_all(const TaskTerm& term) {
  return term.robots.empty() &&
         (term.residual == TaskResidual::kCom || term.residual == TaskResidual::kCentroidalMomentum);
}

void append(std::vector<int>& list, int first, int count) {
  for (int i = 0; i < count; ++i) list.push_back(first + i);
}

// The robots and contacts of a part of the scene. robots, contacts: their indices in the scene. robot_at, contact_at:
// for each robot or contact of the scene, its index in the part, or -1.
struct Share {
  std::vector<int> robots, contacts, robot_at, contact_at;
};

Share share_of(const Scene& scene, const std::vector<int>& robots) {
  Share out{robots, {}, std::vector<int>(scene.robots.size(), -1), std::vector<int>(scene.contacts.size(), -1)};
  for (std::size_t i = 0; i < robots.size(); ++i) out.robot_at[robots[i]] = static_cast<int>(i);
  const auto has = [&](int robot) { return robot < 0 || out.robot_at[robot] >= 0; };
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (!has(scene.contacts[c].A.robot) || !has(scene.contacts[c].B.robot)) continue;
    out.contact_at[c] = static_cast<int>(out.contacts.size());
    out.contacts.push_back(static_cast<int>(c));
  }
  return out;
}

SceneFile scene_of(const SceneFile& whole, const Share& share) {
  SceneFile out;
  out.path = whole.path;
  out.scene.name = whole.scene.name;
  out.scene.gravity = whole.scene.gravity;
  out.scene.damping = whole.scene.damping;
  out.scene.tolerance = whole.scene.tolerance;
  out.scene.moment_length = whole.scene.moment_length;
  std::vector<int> q, v, u;
  for (const int r : share.robots) {
    const Robot& robot = whole.scene.robots[r];
    add_robot(out.scene, robot.name, robot.model, robot.base);
    append(q, robot.idx_q, robot.model->nq);
    append(v, robot.idx_v, robot.model->nv);
    append(u, robot.idx_u, robot.model->nu());
  }
  if (!whole.moved.empty())
    for (const int r : share.robots) out.moved.push_back(whole.moved[r]);
  out.q = whole.q(q);
  out.v = whole.v(v);
  out.u = whole.u(u);
  for (const int c : share.contacts) {
    Contact contact = whole.scene.contacts[c];
    for (Attachment* end : {&contact.A, &contact.B})
      if (end->robot >= 0) end->robot = share.robot_at[end->robot];
    add_contact(out.scene, std::move(contact));
  }
  take_applied_forces(whole.scene, share.robot_at, out.scene);
  return out;
}

// Returns whether a residual has rows for single coordinates, so that one residual contains all robots of its term.
bool is_of_coordinates(TaskResidual residual) {
  return residual == TaskResidual::kState || residual == TaskResidual::kControl ||
         residual == TaskResidual::kJointEffort || residual == TaskResidual::kJointAcceleration;
}

// Returns the part's rows of a term that has one number for each coordinate of the whole scene.
TaskTerm of_part_of_scene(TaskTerm term, const Scene& scene, const Share& share) {
  const std::vector<int> rows = rows_of(term.residual, scene, share.robots);
  term.nr = static_cast<int>(rows.size());
  if (term.reference.size() > 0)
    term.reference = Eigen::VectorXd(
        term.reference(term.residual == TaskResidual::kState ? coordinates_of(scene, share.robots).x : rows));
  for (Eigen::VectorXd* numbers : {&term.weights, &term.lower, &term.upper})
    if (numbers->size() > 0) *numbers = Eigen::VectorXd((*numbers)(rows));
  return term;
}

std::vector<int> of_share(const std::vector<int>& whole, const std::vector<int>& at) {
  std::vector<int> out;
  for (const int i : whole)
    if (at[i] >= 0) out.push_back(at[i]);
  return out;
}

// Divides a term of copied robots or contacts into one term for each copy in the part. Names are as in the whole scene.
std::vector<TaskTerm> copies_of(const TaskTerm& term, std::vector<int> TaskTerm::*all, const std::vector<int>& at) {
  std::vector<TaskTerm> out;
  const std::vector<int>& copies = term.*all;
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const int own = at[copies[i]];
    if (own < 0) continue;
    out.push_back(term);
    out.back().*all = {own};
    if (copies.size() > 1) out.back().name += std::to_string(i);
  }
  return out;
}

// Returns the terms of the part that result from a term of the whole task, or none if the term is about other robots.
std::vector<TaskTerm> terms_of(const TaskTerm& term, const Scene& scene, const Share& share) {
  if (joins_all(term)) return {term};
  if (!term.contacts.empty()) return copies_of(term, &TaskTerm::contacts, share.contact_at);
  if (term.robots.empty()) return {of_part_of_scene(term, scene, share)};
  if (!is_of_coordinates(term.residual)) return copies_of(term, &TaskTerm::robots, share.robot_at);
  TaskTerm own = term;
  own.robots = of_share(term.robots, share.robot_at);
  if (own.robots.empty()) return {};
  return {own};
}

TaskPhase phase_of(const TaskPhase& phase, const Scene& scene, const Share& share) {
  TaskPhase out;
  out.line = phase.line;
  out.nodes = phase.nodes;
  out.impact = phase.impact;
  out.at_scene = phase.at_scene;
  for (const int c : share.contacts) out.active.push_back(phase.active[c]);
  // Wrenches on the part's robots are selected as in take_applied_forces.
  for (std::size_t k = 0; k < phase.wrenches.size(); ++k)
    if (share.robot_at[scene.wrenches[k].at.robot] >= 0) out.wrenches.push_back(phase.wrenches[k]);
  for (auto terms : {&TaskPhase::costs, &TaskPhase::constraints})
    for (const TaskTerm& term : phase.*terms)
      for (TaskTerm& own : terms_of(term, scene, share)) (out.*terms).push_back(std::move(own));
  return out;
}

}  // namespace

void join_ends(const Contact& contact, sparse::UnionFind& sets) {
  if (contact.A.robot >= 0 && contact.B.robot >= 0) sets.join(contact.A.robot, contact.B.robot);
}

void join_robots(const Scene& scene, const std::vector<int>& robots, sparse::UnionFind& sets) {
  for (int r = 1; robots.empty() && r < scene.nrobots(); ++r) sets.join(0, r);
  for (const int r : robots) sets.join(robots.front(), r);
}

std::vector<std::vector<int>> sets_of_robots(const TaskFile& task, const JoinRobots& join) {
  const Scene& scene = task.scene.scene;
  std::vector<int> memory(scene.robots.size());
  sparse::UnionFind sets(memory);
  for (const Spring& spring : scene.springs)
    if (spring.B.robot >= 0) sets.join(spring.A.robot, spring.B.robot);
  for (const TaskPhase& phase : task.phases) join(phase, sets);
  join(task.terminal, sets);
  std::vector<std::vector<int>> out;
  std::vector<std::size_t> at(scene.robots.size());  // index in `out` of each set, stored at the set's first robot
  for (int r = 0; r < scene.nrobots(); ++r) {
    const auto root = static_cast<std::size_t>(sets.root(r));
    if (root == static_cast<std::size_t>(r)) {
      at[root] = out.size();
      out.emplace_back();
    }
    out[at[root]].push_back(r);
  }
  return out;
}

std::vector<std::vector<int>> separate_robots(const TaskFile& task) {
  const Scene& scene = task.scene.scene;
  return sets_of_robots(task, [&](const TaskPhase& phase, sparse::UnionFind& sets) {
    for (std::size_t c = 0; c < scene.contacts.size(); ++c)
      if (phase.active[c]) join_ends(scene.contacts[c], sets);
    for (const auto* terms : {&phase.costs, &phase.constraints})
      for (const TaskTerm& term : *terms)
        if (joins_all(term)) join_robots(scene, {}, sets);
  });
}

TaskFile part_of(const TaskFile& task, const std::vector<int>& robots) {
  const Share share = share_of(task.scene.scene, robots);
  TaskFile out;
  out.path = task.path;
  out.name = task.name;
  out.scene = scene_of(task.scene, share);
  out.step = task.step;
  out.integrator = task.integrator;
  for (const TaskPhase& phase : task.phases) out.phases.push_back(phase_of(phase, task.scene.scene, share));
  out.terminal = phase_of(task.terminal, task.scene.scene, share);
  out.solver_line = task.solver_line;
  out.solver = task.solver;
  out.iterations = task.iterations;
  out.tolerance = task.tolerance;
  out.guess = task.guess;
  return out;
}

ActionPart coordinates_of(const Scene& scene, const std::vector<int>& robots) {
  ActionPart out;
  for (const int r : robots) {
    const Robot& robot = scene.robots[r];
    append(out.x, robot.idx_q, robot.model->nq);
    append(out.dx, robot.idx_v, robot.model->nv);
    append(out.u, robot.idx_u, robot.model->nu());
  }
  for (const int r : robots) {
    const Robot& robot = scene.robots[r];
    append(out.x, scene.nq + robot.idx_v, robot.model->nv);
    append(out.dx, scene.nv + robot.idx_v, robot.model->nv);
  }
  return out;
}

std::vector<int> rows_of(TaskResidual residual, const Scene& scene, const std::vector<int>& robots) {
  ActionPart at = coordinates_of(scene, robots);
  switch (residual) {
    case TaskResidual::kState:
      return at.dx;
    case TaskResidual::kControl:
    case TaskResidual::kJointEffort:
      return at.u;
    default:  // accelerations, and torques against gravity
      at.dx.resize(at.dx.size() / 2);
      return at.dx;
  }
}

}  // namespace manycontact
