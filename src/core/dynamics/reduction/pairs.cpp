// Finds contacts that pairs can replace (reduction.hpp), and makes the reduced scene.

#include <algorithm>
#include <tuple>

#include "../internal.hpp"
#include "reduction.hpp"

namespace manycontact::internal {

namespace {

Reduction::Terms terms_of(const Scene& scene) {
  Reduction::Terms out{{}, scene.damping > 0, has_applied_forces(scene), scene.damping > 0 ? 1 : scene.moment_length};
  out.constant_rows.reserve(scene.contacts.size());
  for (const Contact& contact : scene.contacts) out.constant_rows.push_back(has_constant_rows(contact));
  return out;
}

bool same_terms(const Scene& scene, const Reduction::Terms& terms) {
  if (terms.damped != (scene.damping > 0) || terms.forces != has_applied_forces(scene)) return false;
  if (!terms.damped && terms.moment_length != scene.moment_length) return false;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (terms.constant_rows[c] != has_constant_rows(scene.contacts[c])) return false;
  return true;
}

// Whether a contact may be in a pair. With damping it must join two robots, as derivatives of sliding need all rows.
bool may_reduce(const Scene& scene, const Contact& contact) {
  return has_constant_rows(contact) &&
         (scene.damping == 0 || (joins_robots(contact) && contact.A.robot != contact.B.robot));
}

bool may_reduce(const Scene& scene, const Options& options) {
  return options.reduce_pairs && options.method != Method::kDense && options.method != Method::kDenseSchur &&
         scene.tolerance == 0 && scene.damping >= 0 && scene.moment_length > 0;
}

std::vector<std::vector<int>> find_groups(const Scene& scene) {  // groups: the contacts between the same two bodies
  using Bodies = std::tuple<int, int, int, int>;
  std::vector<std::pair<Bodies, int>> all;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    if (may_reduce(scene, contact))
      all.emplace_back(Bodies{contact.A.robot, contact.A.joint, contact.B.robot, contact.B.joint}, static_cast<int>(c));
  }
  std::sort(all.begin(), all.end());
  std::vector<std::vector<int>> groups;
  for (std::size_t k = 0; k < all.size();) {
    std::vector<int> group;
    const Bodies& bodies = all[k].first;
    for (; k < all.size() && all[k].first == bodies; ++k) group.push_back(all[k].second);
    if (group.size() > 1) groups.push_back(std::move(group));
  }
  return groups;
}

// Returns one flag per contact of a group: whether it is active. group: contacts between the same two bodies.
const std::vector<char>& set_of(const std::vector<int>& group, const std::vector<char>& active, Reduction& r) {
  r.set.clear();
  for (int c : group) r.set.push_back(active[c]);
  return r.set;
}

std::vector<int> contacts_of(const std::vector<int>& group, const std::vector<char>& set) {
  std::vector<int> out;
  for (std::size_t k = 0; k < group.size(); ++k)
    if (set[k]) out.push_back(group[k]);
  return out;
}

// Adds a set of active contacts to group g. Returns whether their rows are dependent, so that the set has a pair.
bool add_pair(const Scene& scene, std::size_t g, const std::vector<char>& set, Reduction& r) {
  const std::vector<int> contacts = contacts_of(r.groups[g], set);
  Reduction::Set of;
  if (contacts.size() > 1) of.pair = pair_of(scene, contacts);
  const bool found = of.pair.pair != nullptr;
  if (found) {
    const auto rows = std::const_pointer_cast<PairRows>(of.pair.pair);
    rows->numbers = *r.numbers.insert(rows->numbers).first;
  }
  r.sets[g].try_emplace(set, std::move(of));
  return found;
}

// Adds to each group (contacts of two bodies) the set of contacts active now. A new set is also added to all other
// groups with as many contacts, as copies of a robot may activate it later. Returns whether there are new pairs.
bool add_sets(const Scene& scene, const std::vector<char>& active, Reduction& r) {
  bool found = false;
  for (std::size_t g = 0; g < r.groups.size(); ++g) {
    const std::vector<char>& known = set_of(r.groups[g], active, r);
    if (r.sets[g].contains(known)) continue;
    const std::vector<char> set = known;
    for (std::size_t other = 0; other < r.groups.size(); ++other)
      if (r.groups[other].size() == set.size() && !r.sets[other].contains(set))
        found = add_pair(scene, other, set, r) || found;
  }
  return found;
}

Contact unnamed(Contact contact) {
  contact.name.clear();
  contact.A.frame.clear();
  contact.B.frame.clear();
  return contact;
}

Scene unnamed(const Scene& from) {  // copies a scene without names
  Scene out;
  out.nq = from.nq, out.nv = from.nv, out.nu = from.nu;
  out.gravity = from.gravity, out.damping = from.damping, out.moment_length = from.moment_length;
  for (const Robot& robot : from.robots)
    out.robots.push_back({{}, robot.model, robot.base, robot.idx_q, robot.idx_v, robot.idx_u});
  for (const Contact& contact : from.contacts) out.contacts.push_back(unnamed(contact));
  out.wrenches = from.wrenches, out.springs = from.springs, out.joint_springs = from.joint_springs;
  return out;
}

void make_scene(const Scene& scene, Reduction& r) {  // the reduced scene; its order of pairs does not depend on history
  r.data.reset();
  r.scene = unnamed(scene);
  r.pairs.clear();
  std::size_t rows = 0;
  for (auto& sets : r.sets)
    for (auto& [set, of] : sets) {
      if (!of.pair.pair) continue;
      of.number = static_cast<int>(r.scene.contacts.size());
      r.pairs.push_back(std::make_shared<PairRows>(*of.pair.pair));  // a copy, updated with the scene
      r.scene.contacts.push_back(of.pair);
      r.scene.contacts.back().pair = r.pairs.back();
      rows = std::max(rows, of.pair.pair->unit.size());
    }
  r.rows_of_pair.resize(static_cast<Eigen::Index>(rows));
}

void set_active(const std::vector<char>& active, Reduction& r, std::vector<char>& out) {  // flags of the reduced scene
  out.assign(r.scene.contacts.size(), 0);
  std::copy(active.begin(), active.end(), out.begin());
  for (std::size_t g = 0; g < r.groups.size(); ++g) {
    const auto set = r.sets[g].find(set_of(r.groups[g], active, r));
    if (set == r.sets[g].end() || set->second.number < 0) continue;
    out[set->second.number] = 1;
    for (int c : r.groups[g]) out[c] = 0;
  }
}

void number_islands(const Scene& scene, Reduction& r) {
  const std::size_t count = island_count(*r.data);
  r.islands.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Island& solved = solved_island(*r.data, i);
    Island& own = r.islands[i];
    own.robots = solved.robots;
    own.contacts.clear();
    for (int c : solved.contacts)
      if (const PairRows* pair = r.pair_of(c))
        own.contacts.insert(own.contacts.end(), pair->contacts.begin(), pair->contacts.end());
      else
        own.contacts.push_back(c);
    std::sort(own.contacts.begin(), own.contacts.end());
    number_island(scene, own);
  }
}

std::unique_ptr<Reduction> begin_reduction(const Scene& scene) {
  auto r = std::make_unique<Reduction>();
  r->terms = terms_of(scene);
  r->groups = find_groups(scene);
  r->sets.resize(r->groups.size());
  return r;
}

}  // namespace

bool has_pairs(const Reduction& r, std::size_t i) {
  return r.islands[i].contacts.size() != solved_island(*r.data, i).contacts.size();
}

bool reduction_is_current(const Scene& scene, const SceneData& data) {
  const Workspace& w = *data.workspace;
  const bool may = may_reduce(scene, data.options);
  return may == (w.pairs != nullptr) && (!may || same_terms(scene, w.pairs->terms));
}

void prepare_reduction(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  w.reduction = nullptr;
  if (!may_reduce(scene, data.options)) return w.pairs.reset();
  if (!w.pairs || !same_terms(scene, w.pairs->terms)) w.pairs = begin_reduction(scene);
  const bool found = add_sets(scene, data.active, *w.pairs);
  if (found) make_scene(scene, *w.pairs);
  if (w.pairs->pairs.empty()) return;
  w.reduction = w.pairs.get();
  Reduction& r = *w.reduction;
  Options options = data.options;
  options.reduce_pairs = false;
  if (options.precision == Precision::kExtended) options.precision = Precision::kDouble;  // refined in the full scene
  if (!r.data) {
    std::vector<char> active;
    set_active(data.active, r, active);
    for (std::size_t c = 0; c < active.size(); ++c) r.scene.contacts[c].active = active[c] != 0;
    r.data = std::make_unique<SceneData>(r.scene, options);
  } else {
    r.data->options = options;
    set_active(data.active, r, r.data->active);
    prepare_checked(r.scene, *r.data);
  }
  number_islands(scene, r);
}

}  // namespace manycontact::internal
