#include <algorithm>

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/place.hpp"
#include "manycontact/analysis/text.hpp"
#include "manycontact/contact/reference.hpp"
#include "manycontact/io/task_file.hpp"
#include "manycontact/model/suggestion.hpp"
#include "moved_most.hpp"

namespace manycontact {

namespace {

// The q that meets the poses and closes the contacts, found from q. file, line: where the contacts are asked for.
Eigen::VectorXd placed(const Scene& scene, const Eigen::VectorXd& q, const std::vector<ScenePose>& poses,
                       const std::vector<bool>& closed, const std::string& file, int line) {
  std::vector<Goal> goals;
  for (const ScenePose& pose : poses)
    goals.push_back(pose_goal(pose.frame, {pose.x, pose.y, pose.z}, {pose.roll, pose.pitch, pose.yaw}));
  for (std::size_t c = 0; c < closed.size(); ++c)
    if (closed[c]) goals.push_back(contact_goal(scene, scene.contacts[c].name));
  const PlacedScene found = place(scene, q, goals);
  if (found.met(kPlacementError)) return found.q;
  const auto size = [](const GoalLeft& left) { return std::max(left.position, left.angle); };
  const auto worst = std::max_element(found.left.begin(), found.left.end(),
                                      [&](const GoalLeft& x, const GoalLeft& y) { return size(x) < size(y); });
  const auto g = static_cast<std::size_t>(worst - found.left.begin());
  const std::string by = in_words(PlacementError{0, worst->position, worst->angle}) +
                         ", expected poses that can be met together, within the joints' limits, from this q";
  if (g >= poses.size())
    throw InputError(file, line, "beside the poses contact " + quote(goals[g].name) + " stays out of place by " + by);
  throw InputError(poses[g].file, poses[g].line, "the pose of " + quote(poses[g].name) + " is missed by " + by);
}

}  // namespace

void place(SceneFile& file) {
  if (file.poses.empty()) return;
  Scene& scene = file.scene;
  std::vector<bool> closed(scene.contacts.size(), false);
  for (std::size_t c = 0; file.consistent_line > 0 && c < scene.contacts.size(); ++c)
    closed[c] = scene.contacts[c].active;
  for (const OpenReference& reference : file.open_references)
    if (reference.position || holds_turning(scene.contacts[reference.contact].type)) closed[reference.contact] = false;
  const Eigen::VectorXd q = placed(scene, file.q, file.poses, closed, file.path, file.consistent_line);
  const std::string moved = internal::moved_most("q", velocity_names(scene), difference(scene, file.q, q));
  file.q = q;
  for (const OpenReference& reference : file.open_references)
    resolve_reference(scene, file.q, reference.position, reference.orientation, scene.contacts[reference.contact]);
  for (const int spring : file.open_lengths)
    scene.springs[spring].length = spring_length(scene, file.q, scene.springs[spring]);
  if (!moved.empty())
    file.findings.push_back(
        {"pose", scene.name, "made to meet the poses" + moved, file.poses[0].file, file.poses[0].line});
}

void place_references(TaskFile& task) {
  const SceneFile& file = task.scene;
  // Contacts that stand where the scene has them: from the start on, or by a phase that closes them there.
  std::vector<bool> held(file.scene.contacts.size(), true), before = held;
  const auto find = [&](TaskPhase& phase) {
    for (std::size_t c = 0; c < held.size(); ++c) {
      held[c] = phase.active[c] && (before[c] ? held[c] : phase.at_scene);
      before[c] = phase.active[c];
    }
    for (std::vector<TaskTerm>* terms : {&phase.costs, &phase.constraints})
      for (TaskTerm& term : *terms) {
        if (term.poses.empty()) continue;
        term.reference.setZero(file.scene.nq + file.scene.nv);
        term.reference.head(file.scene.nq) = placed(file.scene, file.q, term.poses, held, task.path, term.line);
      }
  };
  for (TaskPhase& phase : task.phases) find(phase);
  find(task.terminal);
}

}  // namespace manycontact
