#include <algorithm>

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/place.hpp"
#include "manycontact/analysis/text.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/io/task_file.hpp"
#include "manycontact/model/suggestion.hpp"
#include "moved_most.hpp"
#include "standing.hpp"

namespace manycontact {

namespace {

std::vector<Goal> goals_of(const Scene& scene, const std::vector<ScenePose>& poses, const std::vector<bool>& closed) {
  std::vector<Goal> goals;
  for (const ScenePose& pose : poses) {
    const Partial xyz = {pose.x, pose.y, pose.z};
    goals.push_back(pose.center_of_mass ? center_of_mass_goal(scene, xyz, scene.robots[pose.frame.robot].name)
                                        : pose_goal(pose.frame, xyz, {pose.roll, pose.pitch, pose.yaw}));
  }
  for (std::size_t c = 0; c < closed.size(); ++c)
    if (closed[c]) goals.push_back(contact_goal(scene, scene.contacts[c].name));
  return goals;
}

std::string owner(const ScenePose& pose) {
  return (pose.center_of_mass ? "the pose of the centre of mass of " : "the pose of ") + quote(pose.name);
}

// Throws InputError for the goal with the largest error. line: the line of consistent="true", reported for contacts.
[[noreturn]] void refuse(const std::vector<ScenePose>& poses, const std::vector<Goal>& goals, const PlacedScene& found,
                         const std::string& file, int line) {
  const std::vector<GoalLeft>& left = found.left;
  const auto size = [](const GoalLeft& x) { return std::max(x.position, x.angle); };
  const auto worst = std::ranges::max_element(left, {}, size);
  const auto g = static_cast<std::size_t>(worst - left.begin());
  const std::string by =
      in_words(PlacementError{0, worst->position, worst->angle}) +
      (found.out_of_steps ? " after " + text::count(found.iterations, "step") + " of a search that still improved"
                          : "") +
      ", expected poses that can be met together within the joints' limits by a search from this q"
      " (with the attribute restarts of <scene> the search also starts from random joint positions)";
  if (g >= poses.size())
    throw InputError(file, line, "with these poses contact " + quote(goals[g].name) + " remains out of place by " + by);
  throw InputError(poses[g].file, poses[g].line, owner(poses[g]) + " is missed by " + by);
}

std::vector<internal::Leaning> leaning(const Scene& scene, const Eigen::VectorXd& q,
                                       const std::vector<ScenePose>& poses, const std::vector<bool>& standing) {
  std::vector<internal::Leaning> out = internal::leaning(scene, standing, q);
  std::erase_if(out, [&](const internal::Leaning& x) {
    return std::ranges::none_of(poses, [&](const ScenePose& p) { return p.frame.robot == x.robot; });
  });
  return out;
}

// Returns a configuration in which the robots of `lean` balance, if there is one. First keeps the feet at the relative
// positions that they have in q; if this fails, only balance and `goals` are required.
std::optional<Eigen::VectorXd> upright(const Scene& scene, const Eigen::VectorXd& q, std::vector<Goal> goals,
                                       const std::vector<internal::Leaning>& lean) {
  constexpr double kLittle = 1e-3;  // weight of goals that keep the joint angles, small compared with the other goals
  const auto add = [](std::vector<Goal>& to, std::vector<Goal> more) { to.insert(to.end(), more.begin(), more.end()); };
  for (const internal::Leaning& robot : lean) goals.push_back(internal::standing_goal(scene, robot));
  std::vector<Goal> as_before = goals;
  for (const internal::Leaning& robot : lean) add(as_before, internal::stance_goals(scene, robot, q));
  std::vector<Goal> near = as_before;
  for (const internal::Leaning& robot : lean) add(near, internal::posture_goals(scene, robot, q, kLittle));
  const Eigen::VectorXd from = place(scene, q, near).q;
  for (const std::vector<Goal>* wanted : {&as_before, &goals})
    if (PlacedScene found = place(scene, from, *wanted); found.met(kPlacementError)) return std::move(found.q);
  return std::nullopt;
}

// Returns a configuration that meets the poses and closes the contacts, found from q. If robots would tip over in this
// configuration, one in which they balance is preferred. standing: flags of the contacts that support robots.
Eigen::VectorXd placed(const Scene& scene, const Eigen::VectorXd& q, const std::vector<ScenePose>& poses,
                       const std::vector<bool>& closed, const std::vector<bool>& standing, int restarts,
                       const std::string& file, int line) {
  const std::vector<Goal> goals = goals_of(scene, poses, closed);
  const PlacedScene found = place(scene, q, goals, {.restarts = restarts});
  if (!found.met(kPlacementError)) refuse(poses, goals, found, file, line);
  const std::vector<internal::Leaning> lean = leaning(scene, found.q, poses, standing);
  return lean.empty() ? found.q : upright(scene, q, goals, lean).value_or(found.q);
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
  std::vector<bool> standing;
  for (const Contact& contact : scene.contacts) standing.push_back(contact.active);
  const Eigen::VectorXd q =
      placed(scene, file.q, file.poses, closed, standing, file.restarts, file.path, file.consistent_line);
  const std::string moved = internal::moved_most("q", velocity_names(scene), difference(scene, file.q, q));
  file.q = q;
  for (const OpenReference& reference : file.open_references)
    resolve_reference(scene, file.q, reference.position, reference.orientation, scene.contacts[reference.contact]);
  for (const int spring : file.open_lengths)
    scene.springs[spring].length = spring_length(scene, file.q, scene.springs[spring]);
  if (!moved.empty())
    file.findings.push_back(
        {"pose", scene.name, "q was changed to meet the poses" + moved, file.poses[0].file, file.poses[0].line});
  for (const internal::Leaning& robot : leaning(scene, q, file.poses, standing))
    file.findings.push_back({"pose", scene.robots[robot.robot].name,
                             "the centre of mass is " + text::number(robot.by) +
                                 " m outside of the robot's contacts: the robot cannot balance in this configuration "
                                 "unless contacts pull",
                             file.poses[0].file, file.poses[0].line});
}

void place_references(TaskFile& task) {
  const SceneFile& file = task.scene;
  // Flags of the contacts that close where the scene places them, as references do too: contacts active since the
  // start, and contacts that phases with at="scene" activate.
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
        term.reference.head(file.scene.nq) =
            placed(file.scene, file.q, term.poses, held, phase.active, file.restarts, task.path, term.line);
      }
  };
  for (TaskPhase& phase : task.phases) find(phase);
  find(task.terminal);
}

}  // namespace manycontact
