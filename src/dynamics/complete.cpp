// What a solve leaves out, made when it is asked for.

#include "steps.hpp"
#include "threads.hpp"

namespace manycontact {

void complete(const Scene& scene, const SceneData& data) {
  internal::check_solved(scene, data, "complete");
  Workspace& w = *data.workspace;
  internal::each_item(w, w.islands.size(), [&](std::size_t i, ThreadWork& thread) {
    IslandWork& d = *w.islands[i];
    const bool bodies = d.answered && d.answered == d.bodies.get() && d.bodies->make_current(scene, data);
    if (bodies && joint_space_size(*d.shape) <= kMostJointSpace)
      internal::evaluate_at_solution(scene, data, d);
    else if (!bodies && d.answered && d.matrix.make_current(scene, data, thread) && d.answered == &d.alone)
      d.answered = &d.matrix, d.alone.state = 0;  // derivatives are to be looked at, too
  });
}

}  // namespace manycontact
