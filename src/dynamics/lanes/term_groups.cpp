#include "term_groups.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "../workspace.hpp"

namespace manycontact::lanes {

namespace {

constexpr int kLargestModel = 400;  // velocities: as for islands that stand in lanes

bool is_small(const Model& model) { return model.njoints() > 0 && model.nv <= kLargestModel && !model.M_begin.empty(); }

bool evaluated_in_lanes(const Scene& scene, const IslandWork& d) {
  if (d.choice.method != Method::kSparseLdl && d.choice.method != Method::kSparseSupernodal) return false;
  return d.island.robots.size() > 1 && std::all_of(d.island.robots.begin(), d.island.robots.end(),
                                                   [&](int r) { return is_small(*scene.robots[r].model); });
}

void add_robot_to_group(const Scene& scene, const Level& level, std::size_t threads, int r, TermGroups& g) {
  const std::shared_ptr<const Model>& model = scene.robots[r].model;
  TermGroups::Robots& group = g.robots[model];
  while (group.kernels.size() < threads) group.kernels.push_back(level.make_robots(model));
  if (!group.members.empty())
    for (const auto& kernel : group.kernels) kernel->widen();
  group.members.push_back(r);
}

TermGroups::ContactKey key_of(const Scene& scene, const Contact& contact) {
  const Model* B = contact.B.robot < 0 ? nullptr : scene.robots[contact.B.robot].model.get();
  return {scene.robots[contact.A.robot].model.get(),
          B,
          contact.A.robot == contact.B.robot,
          contact.type,
          contact.A.joint,
          contact.B.joint};
}

void add_contact_to_group(const Scene& scene, const Workspace& w, const Level& level, int c, TermGroups& g) {
  const Contact& contact = scene.contacts[c];
  if (!moves_at_both_ends(contact)) return g.other_contacts.push_back(c);
  TermGroups::Contacts& group = g.contacts[key_of(scene, contact)];
  while (group.kernels.size() < w.threads.size())
    group.kernels.push_back(level.make_contacts(scene, contact, w.supports[c]));
  if (!group.members.empty())
    for (const auto& kernel : group.kernels) kernel->widen(scene, contact, w.supports[c]);
  group.members.push_back(c);
}

}  // namespace

bool before(const Contact& x, const Contact& y) {
  const auto numbers = [](const Contact& c) {
    return std::array<double, 6>{
        static_cast<double>(c.reference_frame), c.alpha, c.beta, c.axis[0], c.axis[1], c.axis[2]};
  };
  const auto a = numbers(x), b = numbers(y);
  return std::memcmp(a.data(), b.data(), sizeof a) < 0;  // of bits: NaN has its place too
}

TermGroups::Contacts& group_of(const Scene& scene, Workspace& w, int contact) {
  return w.term_groups.contacts.at(key_of(scene, scene.contacts[contact]));
}

void regroup_terms(const Scene& scene, Workspace& w) {
  TermGroups& g = w.term_groups;
  for (auto& [model, group] : g.robots) group.members.clear();
  for (auto& [key, group] : g.contacts) group.members.clear();
  g.other_contacts.clear();
  g.robot_batches.clear();
  g.contact_batches.clear();
  for (const std::unique_ptr<IslandWork>& d : w.islands) d->terms_in_lanes = false;
  const Level* level = w.lanes.level;
  if (!level) return;
  for (ThreadWork& thread : w.threads) {
    thread.robots.reserve(level->width);
    thread.rows.reserve(level->width);
    thread.joining.reserve(level->width);
  }
  for (const std::unique_ptr<IslandWork>& d : w.islands) {
    if (!evaluated_in_lanes(scene, *d)) continue;
    d->terms_in_lanes = true;
    for (int r : d->island.robots) add_robot_to_group(scene, *level, w.threads.size(), r, g);
    for (int c : d->island.contacts) add_contact_to_group(scene, w, *level, c, g);
  }
  for (const auto& [model, group] : g.robots) {
    const int count = static_cast<int>(group.members.size());
    for (int first = 0; first < count; first += level->width)
      g.robot_batches.push_back({&group, first, std::min(level->width, count - first)});
  }
  std::size_t contacts = 0;
  for (const auto& [key, group] : g.contacts) contacts += group.members.size();
  g.contact_batches.reserve(contacts);
  for (auto& [key, group] : g.contacts)
    std::sort(group.members.begin(), group.members.end(), [&](int x, int y) {
      const Contact &c = scene.contacts[x], &d = scene.contacts[y];
      return before(c, d) || (x < y && !before(d, c));
    });
}

}  // namespace manycontact::lanes
