// Kinematics, bias, inertia and contact rows of islands of several robots, in lanes.

#include "steps.hpp"

namespace manycontact::internal {

namespace {

lanes::RobotTerms::Robot at_state(const Scene& scene, const SceneData& data, int number) {
  Workspace& w = *data.workspace;
  const Robot& robot = scene.robots[number];
  RobotData& r = w.robots[number];
  return {w.q.data() + robot.idx_q, data.v.data() + robot.idx_v, robot.base.R.data(),
          lanes::RobotTerms::arrays_of(r.kin, r.Yc, r.M.data(), r.h.data()), false};
}

void evaluate_robots(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  lanes::TermGroups& g = w.term_groups;
  const std::size_t width = g.robots.empty() ? 0 : w.lanes.level->width;
  for (auto& [model, group] : g.robots)
    for (std::size_t first = 0; first < group.members.size(); first += width) {
      const std::span members = std::span(group.members).subspan(first, std::min(width, group.members.size() - first));
      g.robots_at_hand.clear();
      for (int r : members) g.robots_at_hand.push_back(at_state(scene, data, r));
      group.kernel->evaluate(scene.gravity, g.robots_at_hand);
      for (std::size_t k = 0; k < members.size(); ++k) {
        w.robots[members[k]].known = true;
        if (!g.robots_at_hand[k].sound) evaluate_robot(scene, w.q, data.v, w, members[k]);
      }
    }
}

lanes::ContactTerms::Body body(const Workspace& w, int robot) {
  const Kinematics<double>& kin = w.robots[robot].kin;
  return {kin.origin.data(), kin.oMi.front().R.data(), kin.v.front().data(), kin.a.front().data(), kin.J.data()};
}

void evaluate_contacts(const Scene& scene, Workspace& w) {
  lanes::TermGroups& g = w.term_groups;
  for (auto& entry : g.contacts) {
    lanes::TermGroups::Contacts& group = entry.second;  // lambdas of C++20 capture it
    const Contact* first = nullptr;
    const auto evaluate_those_at_hand = [&] {
      if (!g.rows_at_hand.empty()) group.kernel->evaluate(scene.gravity, *first, g.rows_at_hand);
      g.rows_at_hand.clear();
    };
    for (int c : group.members) {
      const Contact& contact = scene.contacts[c];
      if (!g.rows_at_hand.empty() && !lanes::alike_rows(*first, contact)) evaluate_those_at_hand();
      if (g.rows_at_hand.empty()) first = &contact;
      const auto A = body(w, contact.A.robot);
      g.rows_at_hand.push_back({A, contact.B.robot < 0 ? A : body(w, contact.B.robot), contact.A.placement.R.data(),
                                contact.B.placement.R.data(), lanes::ContactTerms::arrays_of(w.contacts[c])});
      if (static_cast<int>(g.rows_at_hand.size()) == w.lanes.level->width) evaluate_those_at_hand();
    }
    evaluate_those_at_hand();
  }
  for (int c : g.other_contacts) evaluate_contact(scene, w, c);
}

}  // namespace

void evaluate_in_lanes(const Scene& scene, SceneData& data) {
  evaluate_robots(scene, data);
  evaluate_contacts(scene, *data.workspace);
}

}  // namespace manycontact::internal
