#include <algorithm>

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/place.hpp"
#include "manycontact/analysis/text.hpp"
#include "manycontact/contact/reference.hpp"
#include "manycontact/model/suggestion.hpp"
#include "moved_most.hpp"

namespace manycontact {

void place(SceneFile& file) {
  if (file.poses.empty()) return;
  Scene& scene = file.scene;
  std::vector<Goal> goals;
  for (const ScenePose& pose : file.poses)
    goals.push_back(pose_goal(pose.frame, {pose.x, pose.y, pose.z}, {pose.roll, pose.pitch, pose.yaw}));
  std::vector<char> open(scene.contacts.size(), 0);
  for (const OpenReference& reference : file.open_references)
    if (reference.position || holds_turning(scene.contacts[reference.contact].type)) open[reference.contact] = 1;
  for (std::size_t c = 0; file.consistent_line > 0 && c < scene.contacts.size(); ++c)
    if (scene.contacts[c].active && !open[c]) goals.push_back(contact_goal(scene, scene.contacts[c].name));

  const PlacedScene found = place(scene, file.q, goals);
  if (!found.met(kPlacementError)) {
    const auto size = [](const GoalLeft& left) { return std::max(left.position, left.angle); };
    const auto worst = std::max_element(found.left.begin(), found.left.end(),
                                        [&](const GoalLeft& x, const GoalLeft& y) { return size(x) < size(y); });
    const auto g = static_cast<std::size_t>(worst - found.left.begin());
    const std::string by = in_words(PlacementError{0, worst->position, worst->angle}) +
                           ", expected poses that can be met together, within the joints' limits, from this q";
    if (g >= file.poses.size())
      throw InputError(file.path, file.consistent_line,
                       "beside the poses contact " + quote(goals[g].name) + " stays out of place by " + by);
    const ScenePose& pose = file.poses[g];
    throw InputError(pose.file, pose.line, "the pose of " + quote(pose.name) + " is missed by " + by);
  }
  const std::string moved = internal::moved_most("q", velocity_names(scene), difference(scene, file.q, found.q));
  file.q = found.q;
  for (const OpenReference& reference : file.open_references)
    resolve_reference(scene, file.q, reference.position, reference.orientation, scene.contacts[reference.contact]);
  for (const int spring : file.open_lengths)
    scene.springs[spring].length = spring_length(scene, file.q, scene.springs[spring]);
  if (!moved.empty())
    file.findings.push_back(
        {"pose", scene.name, "made to meet the poses" + moved, file.poses[0].file, file.poses[0].line});
}

}  // namespace manycontact
