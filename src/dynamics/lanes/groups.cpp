#include "groups.hpp"

#include "../workspace.hpp"

namespace manycontact::lanes {

void regroup(const Scene& scene, Workspace& w) {
  Groups& g = w.lanes;
  for (auto& [key, group] : g.groups) group.islands.clear();
  g.level = level_of(w.options.lanes);
  if (!g.level) return;
  g.numbers.reserve(w.islands.size());
  g.islands.reserve(w.islands.size());
  g.batches.reserve(w.islands.size());
  for (ThreadWork& thread : w.threads) {
    thread.answers.resize(g.level->width);
    thread.panels.reserve(g.level->width);
  }
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    IslandWork& d = *w.islands[i];
    if (d.choice.method != Method::kSparseLdl || !fits(scene, d.island)) continue;
    const std::shared_ptr<const KktPattern>& pattern = d.shape->pattern(d.choice.order);
    if (!pattern->schedule().compiled) continue;
    const std::shared_ptr<const Model>& model = scene.robots[d.island.robots.front()].model;
    Group& group = g.groups[{d.shape.get(), model.get()}];
    group.model = model;
    while (group.kernels.size() < w.threads.size())
      group.kernels.push_back(g.level->make(scene, d.island, d.shape->support(), pattern));
    if (!group.islands.empty())
      for (const auto& kernel : group.kernels) kernel->widen(scene, d.island, d.shape->support(), pattern);
    group.islands.push_back(static_cast<int>(i));
  }
}

}  // namespace manycontact::lanes
