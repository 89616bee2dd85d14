// Kinematics, bias, inertia and contact rows of islands of several robots, in lanes.

#include <algorithm>

#include "steps.hpp"
#include "threads.hpp"

namespace manycontact::internal {

namespace {

using Wanted = bool (*)(const IslandWork&);

lanes::RobotTerms::Robot at_state(const Scene& scene, const SceneData& data, int number) {
  Workspace& w = *data.workspace;
  const Robot& robot = scene.robots[number];
  RobotData& r = w.robots[number];
  return {w.q.data() + robot.idx_q, data.v.data() + robot.idx_v, robot.base.R.data(),
          lanes::RobotTerms::arrays_of(r.kin, r.Yc, r.M.data(), r.h.data()), false};
}

void evaluate_robots(const Scene& scene, const SceneData& data, Wanted wanted) {
  Workspace& w = *data.workspace;
  lanes::TermGroups& g = w.term_groups;
  each_item(w, g.robot_batches.size(), [&](std::size_t batch, ThreadWork& thread) {
    const std::span<const int> members = g.robot_batches[batch].members();
    if (std::none_of(members.begin(), members.end(), [&](int r) { return wanted(*w.islands[w.robot_island[r]]); }))
      return;
    thread.robots.clear();
    for (int r : members) thread.robots.push_back(at_state(scene, data, r));
    g.robot_batches[batch].group->kernels[thread.number]->evaluate(scene.gravity, thread.robots);
    for (std::size_t k = 0; k < members.size(); ++k) {
      w.robots[members[k]].known = true;
      if (!thread.robots[k].sound) evaluate_robot(scene, w.q, data.v, w, members[k]);
    }
  });
}

lanes::ContactTerms::Body body(const Workspace& w, int robot) {
  const Kinematics<double>& kin = w.robots[robot].kin;
  return {kin.origins.front().p.data(), kin.oMi.front().R.data(), kin.v.front().data(), kin.a.front().data(),
          kin.J.data()};
}

void evaluate_contacts(const Scene& scene, Workspace& w, Wanted wanted) {
  lanes::TermGroups& g = w.term_groups;
  const auto left_out = [&](int c) { return !wanted(*w.islands[w.robot_island[robot_of(scene.contacts[c])]]); };
  g.contact_batches.clear();
  for (const auto& [key, group] : g.contacts)
    for (std::size_t k = 0; k < group.members.size(); ++k) {
      if (left_out(group.members[k])) continue;
      const auto* last = g.contact_batches.empty() ? nullptr : &g.contact_batches.back();
      if (!last || last->group != &group || last->first + last->count != static_cast<int>(k) ||
          last->count == w.lanes.level->width ||
          !lanes::alike_rows(scene.contacts[last->members().front()], scene.contacts[group.members[k]]))
        g.contact_batches.push_back({&group, static_cast<int>(k), 0});
      ++g.contact_batches.back().count;
    }
  each_item(w, g.contact_batches.size(), [&](std::size_t batch, ThreadWork& thread) {
    const std::span<const int> members = g.contact_batches[batch].members();
    thread.rows.clear();
    for (int c : members) {
      const Contact& contact = scene.contacts[c];
      const auto A = body(w, contact.A.robot);
      thread.rows.push_back({A, contact.B.robot < 0 ? A : body(w, contact.B.robot), contact.A.placement.R.data(),
                             contact.B.placement.R.data(), lanes::ContactTerms::arrays_of(w.contacts[c])});
    }
    g.contact_batches[batch].group->kernels[thread.number]->evaluate(scene.gravity, scene.contacts[members.front()],
                                                                     thread.rows);
  });
  for (int c : g.other_contacts)
    if (!left_out(c)) evaluate_contact(scene, w, c);
}

}  // namespace

void evaluate_in_lanes(const Scene& scene, const SceneData& data, bool (*wanted)(const IslandWork&)) {
  evaluate_robots(scene, data, wanted);
  evaluate_contacts(scene, *data.workspace, wanted);
}

}  // namespace manycontact::internal
