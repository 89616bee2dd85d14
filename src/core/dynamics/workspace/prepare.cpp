// Updates islands after contacts were switched. Only islands with switched contacts change; shapes are analysed once.

#include <algorithm>
#include <set>
#include <stdexcept>

#include "../internal.hpp"
#include "../systems/robots/derivatives.hpp"
#include "manycontact/dynamics/give_up_solution.hpp"
#include "manycontact/kkt/choose.hpp"

namespace manycontact {

IslandWork::IslandWork(std::shared_ptr<IslandShape> s, const Options& options)
    : shape(std::move(s)), choice(choose(*shape, options)), matrix(*this) {
  if (choice.method == Method::kSparseBodies)
    bodies = std::make_unique<BodiesSystem>(*this, lanes::level_of(options.simd_level));
}

namespace {

// Returns an island to the pool of its shape, without its results, for the next island of this shape.
void pool_island(Workspace& w, std::unique_ptr<IslandWork> island) {
  island->answered = nullptr;
  island->depended = 0;
  island->matrix.state = 0;
  w.pool.give(std::move(island), w.layout);
}

Options options_of_islands(const Workspace& w) {  // a reduction uses them only for views, so any order will do
  Options options = w.options;
  if (w.reduction) options.method = Method::kSparseLdl, options.order = Order::kLeafToRoot;
  return options;
}

// Takes an island of this shape from the pool, or constructs one, and assigns its robots and contacts.
std::unique_ptr<IslandWork> take(const Scene& scene, Workspace& w, Island& island) {
  const std::shared_ptr<IslandShape>& shape = w.shapes.find(scene, island, w.reduction != nullptr);
  std::unique_ptr<IslandWork> out = w.pool.take(*shape);
  const bool known = out != nullptr;
  if (!known) out = std::make_unique<IslandWork>(shape, options_of_islands(w));
  std::swap(out->island, island);
  out->matrix.M.clear();
  out->matrix.J.clear();
  if (!w.reduction) known ? internal::bind_robots(scene, w, *out) : internal::plan_robots(scene, w, *out);
  return out;
}

void make_first_systems(const Scene& scene, Workspace& w) {  // allocates the systems to be tried first, but no batches
  for (const auto& island : w.islands) {
    IslandWork& d = *island;
    if (d.bodies) {
      for (int c : d.island.contacts)
        if (!w.contacts.has(c)) w.contacts.make(c, scene.contacts[c], ContactSupport{});
    } else if (!d.matrix.has_terms() && !d.stands_in_lanes()) {
      internal::make_joint_space(scene, w, d);
      d.matrix.make_room(d.choice.order);
    }
  }
}

// Flags (s.groups.loose) the robots of all islands on which a contact was switched.
void mark_changed(const Scene& scene, const SceneData& data, Workspace& w, Switching& s, bool all) {
  s.groups.loose.assign(scene.robots.size(), all ? 1 : 0);
  if (all) return;
  const auto mark_island_of = [&](const Attachment& end) {
    if (moves(end) && !s.groups.loose[end.robot])
      for (int r : w.islands[w.robot_island[end.robot]]->island.robots) s.groups.loose[r] = 1;
  };
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (w.islands_active[c] == data.active[c]) continue;
    mark_island_of(scene.contacts[c].A);
    mark_island_of(scene.contacts[c].B);
  }
}

// Sets w.islands to the unchanged islands and to new islands of the robots flagged by mark_changed.
void change_islands(const Scene& scene, const SceneData& data, Workspace& w, bool all) {
  Switching& s = w.switching;
  mark_changed(scene, data, w, s, all);
  s.next.clear();
  s.old.clear();
  s.old.swap(w.islands);  // w.islands stays empty if an allocation throws
  for (std::unique_ptr<IslandWork>& island : s.old) {
    if (s.groups.loose[island->island.robots.front()])
      pool_island(w, std::move(island));
    else
      s.next.push_back(std::move(island));
  }
  s.old.clear();
  const bool whole = data.options.method == Method::kDenseSchur;
  const std::size_t count = group_robots(scene, data.active, whole, s.groups);
  for (std::size_t k = 0; k < count; ++k) s.next.push_back(take(scene, w, s.groups.islands[k]));
  w.islands.swap(s.next);
  std::sort(w.islands.begin(), w.islands.end(),
            [](const auto& x, const auto& y) { return x->island.robots.front() < y->island.robots.front(); });
  w.robot_island.resize(scene.robots.size());
  for (std::size_t i = 0; i < w.islands.size(); ++i)
    for (int r : w.islands[i]->island.robots) w.robot_island[r] = static_cast<int>(i);
}

void forget_unused(Workspace& w) {  // frees analyses and kernels of islands that are neither current nor pooled
  std::set<const IslandShape*> used;
  for (const auto& island : w.islands) used.insert(island->shape.get());
  w.pool.each([&used](const IslandWork& island) { used.insert(island.shape.get()); });
  w.shapes.keep(used);
  internal::forget_unused_groups(w);
}

void keep_derivatives(Workspace& w) {  // moves their memory into the islands, so that the pool keeps it with each
  for (std::size_t i = 0; i < w.derivatives.islands.size() && i < w.islands.size(); ++i)
    w.islands[i]->derivatives = std::move(w.derivatives.islands[i]);
}
void restore_derivatives(Workspace& w) {
  if (w.derivatives.islands.empty()) return;
  w.derivatives.islands.resize(w.islands.size());
  for (std::size_t i = 0; i < w.islands.size(); ++i) w.derivatives.islands[i] = std::move(w.islands[i]->derivatives);
}

void make_threads(int count, Workspace& w) {
  if (count < 0 || count > kMostThreads)
    throw std::invalid_argument("prepare: options.threads is " + std::to_string(count) + ", expected 0 to " +
                                std::to_string(kMostThreads));
  if (count == 0) count = internal::default_threads();
  w.threads.resize(count);
  w.failures.resize(count);
  for (int k = 0; k < count; ++k) w.threads[k].number = k;
}

void lay_out_forces(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  data.f_offset.assign(scene.contacts.size(), -1);
  int rows = 0;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (!data.active[c]) continue;
    data.f_offset[c] = rows;
    rows += scene.contacts[c].rows();
  }
  if (data.f.size() != rows) {
    w.spare_f[data.f.size()].swap(data.f);
    data.f.swap(w.spare_f[rows]);
    internal::remake(data.f, rows);
  }
  data.f.setZero();
}

}  // namespace

void prepare(const Scene& scene, SceneData& data) {
  internal::check_scene(scene, data, "prepare");
  internal::prepare_checked(scene, data);
}

void internal::prepare_islands(const Scene& scene, const SceneData& data) {
  Workspace& w = *data.workspace;
  const bool same_options = w.islands_options == data.options;
  const bool known = same_options && w.springs == scene.springs.size();
  if (known && w.islands_active == data.active) return;
  const bool all = !known || data.options.method == Method::kDenseSchur;
  w.islands_options.reset();
  if (!w.reduction) keep_derivatives(w);  // else derivatives belong to the reduced scene's islands
  if (!same_options) {                    // options changed: factors must be rebuilt
    w.islands.clear();
    w.pool.clear();
    w.lanes = {};
    if (!w.reduction) w.derivatives.islands.clear();
    make_threads(data.options.threads, w);
  }
  w.lanes.level = lanes::level_of(data.options.simd_level);
  w.options = data.options;
  change_islands(scene, data, w, all);
  if (w.linearisation) w.linearisation->forget_places();
  group_robots_alone(w);
  make_first_systems(scene, w);
  if (w.pool.trim()) forget_unused(w);
  if (!w.reduction) restore_derivatives(w);
  w.islands_active = data.active;
  w.springs = scene.springs.size();
  ++w.layout;
  w.islands_options = data.options;
}

void internal::prepare_checked(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  if (data.active.size() != scene.contacts.size())
    throw std::invalid_argument("prepare: data.active has " + std::to_string(data.active.size()) +
                                " flags, the scene has " + std::to_string(scene.contacts.size()) + " contacts");
  if (w.prepared && w.options == data.options && w.springs == scene.springs.size() && w.active == data.active &&
      reduction_is_current(scene, data))
    return;
  give_up_solution(data);
  w.prepared = false;
  prepare_reduction(scene, data);
  if (w.reduction) {
    w.options = data.options;
    w.springs = scene.springs.size();
    w.islands.clear();
    w.islands_options.reset();
    w.derivatives.islands.resize(w.reduction->islands.size());
  } else {
    prepare_islands(scene, data);
  }
  lay_out_forces(scene, data);
  data.report.islands.resize(w.reduction ? w.reduction->islands.size() : w.islands.size());
  w.active = data.active;
  w.prepared = true;
}

}  // namespace manycontact
