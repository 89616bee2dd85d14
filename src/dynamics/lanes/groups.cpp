#include "groups.hpp"

#include "../workspace.hpp"

namespace manycontact::lanes {

void regroup(const Scene& scene, Workspace& w) {
  Groups& g = w.lanes;
  for (auto& [key, group] : g.groups) group.islands.clear();
  g.level = level_of(w.options.lanes);
  if (!g.level) return;
  g.numbers.reserve(g.level->width);
  g.islands.reserve(g.level->width);
  g.answers.resize(g.level->width);
  g.panels.reserve(g.level->width);
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    IslandWork& d = *w.islands[i];
    if (d.choice.method != Method::kSparseLdl || !fits(scene, d.island)) continue;
    const std::shared_ptr<const KktPattern>& pattern = d.shape->pattern(d.choice.order);
    if (!pattern->schedule().compiled) continue;
    const std::shared_ptr<const Model>& model = scene.robots[d.island.robots.front()].model;
    Group& group = g.groups[{d.shape.get(), model.get()}];
    if (!group.kernel) {
      group.model = model;
      group.kernel = g.level->make(scene, d.island, d.shape->support(), pattern);
    }
    if (!group.islands.empty()) group.kernel->widen(scene, d.island, d.shape->support(), pattern);
    group.islands.push_back(static_cast<int>(i));
  }
}

}  // namespace manycontact::lanes
