// What lanes and parts leave out, made when it is asked for.

#include "bodies.hpp"
#include "steps.hpp"
#include "systems/robots/robots.hpp"
#include "threads.hpp"

namespace manycontact {

namespace internal {

void complete(const Scene& scene, const SceneData& data) {
  Workspace& w = *data.workspace;
  for (std::unique_ptr<IslandWork>& d : w.islands) complete_bodies(scene, data, *d, w.threads.front());
  for (std::unique_ptr<IslandWork>& d : w.islands)
    if (by_bodies(*d) && joint_space_size(*d->shape) <= kMostJointSpace) joint_space_terms(scene, data, *d, "complete");
  each_item(w, w.islands.size(), [&](std::size_t i, ThreadWork& thread) {
    if (w.islands[i]->in_lanes) complete_island(scene, data, *w.islands[i], thread);
  });
  w.kinematics_known = true;
}

void complete_island(const Scene& scene, const SceneData& data, IslandWork& d, ThreadWork& thread) {
  Workspace& w = *data.workspace;
  if (!d.joined || !d.joined->terms_known) evaluate(scene, w.q, data.v, w, d.island);
  factorize_again(scene, data, d, thread);
  d.in_lanes = false;
}

}  // namespace internal

void complete(const Scene& scene, const SceneData& data) {
  internal::check_solved(scene, data, "complete");
  internal::complete(scene, data);
}

}  // namespace manycontact
