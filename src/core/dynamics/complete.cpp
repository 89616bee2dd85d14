#include "internal.hpp"
#include "workspace/threads.hpp"

namespace manycontact {

namespace {

// Evaluates motions, rows and K of the scene's own contacts, after a reduction was solved in their place.
void show_contacts(const Scene& scene, const SceneData& data) {
  internal::prepare_islands(scene, data);
  Workspace& w = *data.workspace;
  for (const auto& island : w.islands) {
    MatrixSystem& m = island->matrix;
    if (m.state == w.state) continue;
    internal::evaluate_at_state(scene, data, *island);
    internal::assemble(scene, data, island->choice.order, scene.damping, m);
    m.state = w.state;
  }
}

}  // namespace

void complete(const Scene& scene, const SceneData& data) {
  internal::check_solved(scene, data, "complete");
  Workspace& w = *data.workspace;
  if (w.reduction) return show_contacts(scene, data);
  internal::each_item(w, w.islands.size(), [&](std::size_t i, ThreadWork& thread) {
    IslandWork& d = *w.islands[i];
    if (d.answered_by(d.bodies.get()) && d.bodies->make_current(scene, data)) {
      if (internal::joint_space_fits(d)) internal::evaluate_at_state(scene, data, d);
    } else if (d.answered && d.matrix.make_current(scene, data, thread) && d.answered_by(&IslandWork::batches)) {
      d.answered = &d.matrix;  // the whole K differentiates it now: SIMD batches keep no terms
    }
  });
}

}  // namespace manycontact
