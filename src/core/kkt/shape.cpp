#include "manycontact/kkt/shape.hpp"

#include <algorithm>
#include <bit>

#include "manycontact/contact/pair_rows.hpp"
#include "manycontact/kkt/choose.hpp"
#include "manycontact/sparse/ordering.hpp"
#include "manycontact/sparse/relaxed_supernodes.hpp"

namespace manycontact {

namespace {

// Return the bodies of a contact's ends, robots numbered in the island. An immovable A counts as on B's robot.
Attachment body_A(const Island& island, const Contact& contact) {
  return {local_robot(island, robot_of(contact)), contact.A.joint, {}};
}
Attachment body_B(const Island& island, const Contact& contact) {
  if (!moves(contact.B)) return {};
  return {local_robot(island, contact.B.robot), contact.B.joint, {}};
}

// Whether the contact's position on A's body matters; six rows constrain all motions, wherever they are.
bool place_counts(const Contact& contact) { return contact.type != ContactType::k6D || contact.rows() < 6; }

// Sorts the rows of each contact in an elimination order. K's pattern remains: rows of a contact have equal columns.
std::vector<int> sort_rows(const Island& island, std::vector<int> perm) {
  std::vector<int> place = sparse::inverse(perm);
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const int first = island.nv + island.row_offset[c];
    const int end = c + 1 < island.contacts.size() ? island.nv + island.row_offset[c + 1] : island.size();
    std::sort(place.begin() + first, place.begin() + end);
  }
  return sparse::inverse(place);
}

}  // namespace

IslandShape::IslandShape(const Scene& scene, const Island& island) {
  scene_.robots.reserve(island.robots.size());
  scene_.contacts.reserve(island.contacts.size());
  for (int r : island.robots) add_robot(scene_, std::to_string(scene_.nrobots()), scene.robots[r].model);
  for (int c : island.contacts) {
    const Contact& from = scene.contacts[c];
    Contact to;
    to.type = from.type;
    to.pair = from.pair, to.pair_rank = from.pair_rank;
    to.A = body_A(island, from);
    to.B = body_B(island, from);
    if (place_counts(from)) to.A.placement = from.A.placement;
    if (has_axis(from.type)) to.axis = from.axis;
    scene_.contacts.push_back(to);
  }
  island_ = whole_scene(scene_, std::vector<char>(scene_.contacts.size(), 1));
}

const IslandSupport& IslandShape::support() const {
  const std::lock_guard lock(mutex_);
  if (!support_) support_ = island_support(scene_, island_);
  return *support_;
}

const std::vector<int>& IslandShape::permutation(Order order) {
  const std::lock_guard lock(mutex_);
  auto& perm = permutations_[static_cast<std::size_t>(order)];
  if (perm) return *perm;
  if (order == Order::kLeafToRoot)
    perm = leaf_to_root_order(scene_, island_, permutation(Order::kCamd));
  else if (order == Order::kContactsEarly)
    perm = contacts_early_order(scene_, island_, support(), natural_pattern(scene_, island_, support()));
  else
    perm = sort_rows(island_, camd_order(scene_, island_, natural_pattern(scene_, island_, support())));
  return *perm;
}

const sparse::LdlCounts& IslandShape::counts(Order order) {
  const std::lock_guard lock(mutex_);
  auto& counts = counts_[static_cast<std::size_t>(order)];
  if (counts) return *counts;
  const sparse::UpperCsc K = natural_pattern(scene_, island_, support());
  for (const Order each : kOrders)  // all orders are counted, as callers compare them
    counts_[static_cast<std::size_t>(each)] = sparse::ldl_count(sparse::permute(K, sparse::inverse(permutation(each))));
  return *counts;
}

const std::shared_ptr<const BodyPattern>& IslandShape::bodies() {
  const std::lock_guard lock(mutex_);
  if (!bodies_) bodies_ = std::make_shared<const BodyPattern>(analyze_bodies(scene_, island_));
  return bodies_;
}

const BodySubtrees& IslandShape::body_subtrees() {
  const BodyPattern& whole = *bodies();
  const std::lock_guard lock(mutex_);
  if (!body_parts_) body_parts_ = std::make_unique<const BodySubtrees>(split_bodies(island_, whole));
  return *body_parts_;
}

const std::shared_ptr<const KktPattern>& IslandShape::pattern(Order order) {
  const std::lock_guard lock(mutex_);
  auto& p = patterns_[static_cast<std::size_t>(order)];
  if (p) return p;
  KktPattern fresh =
      analyze(scene_, island_, support(), natural_pattern(scene_, island_, support()), order, permutation(order));
  sparse::relax_supernodes(fresh.ldl);
  return p = std::make_shared<const KktPattern>(std::move(fresh));
}

const std::shared_ptr<const sparse::CholmodSymbolic>& IslandShape::cholmod(Order order) {
  const std::lock_guard lock(mutex_);
  auto& symbolic = cholmod_[static_cast<std::size_t>(order)];
  if (!symbolic) symbolic = std::make_shared<const sparse::CholmodSymbolic>(pattern(order)->K);
  return symbolic;
}

namespace {

std::uint64_t word(int robot, int joint) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(robot)) << 32 | static_cast<std::uint32_t>(joint);
}

void add_structure(const Scene& scene, const Island& island, Words& key) {  // trees, and types and bodies of contacts
  key.insert(key.end(), {island.robots.size(), island.contacts.size()});
  for (int r : island.robots) key.push_back(reinterpret_cast<std::uint64_t>(scene.robots[r].model->structure.get()));
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    const Attachment A = body_A(island, contact), B = body_B(island, contact);
    key.insert(key.end(),
               {static_cast<std::uint64_t>(kind_of(contact)), word(A.robot, A.joint), word(B.robot, B.joint)});
  }
}

// Adds to the key all other numbers on which the order contacts-early depends: models, and the placements and axes of
// contacts that IslandShape keeps.
void add_places(const Scene& scene, const Island& island, Words& key) {
  for (int r : island.robots) key.push_back(reinterpret_cast<std::uint64_t>(scene.robots[r].model.get()));
  const auto add = [&key](const auto& numbers) {
    for (double x : numbers.reshaped()) key.push_back(std::bit_cast<std::uint64_t>(x));
  };
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    if (place_counts(contact)) add(contact.A.placement.R), add(contact.A.placement.p);
    if (has_axis(contact.type)) add(contact.axis);
    if (!contact.pair || !place_counts(contact)) continue;
    for (const double x : contact.pair->numbers->R.reshaped())  // rounded, as equal contacts differ by rounding
      key.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(x)));
  }
}

void reserve(const Island& island, Words& key) {
  key.reserve(2 + 2 * island.robots.size() + 54 * island.contacts.size());
}

}  // namespace

const std::shared_ptr<IslandShape>& ShapeCache::find(const Scene& scene, const Island& island, bool by_places) {
  // at_hand has all shapes in use. Data of one scene, such as the nodes of a horizon, share them in the processor's
  // caches. A shape keeps the models alive whose addresses are in its key.
  static Interned<IslandShape> at_hand;
  key_.clear();
  reserve(island, key_);
  add_structure(scene, island, key_);
  add_places(scene, island, key_);
  if (const auto known = by_places_.find(key_); known != by_places_.end()) return known->second;

  auto [fresh, places] = at_hand.find(key_, [&] { return std::make_shared<IslandShape>(scene, island); });
  if (by_places || is_deep(*fresh)) {
    const auto& deep = shapes_.try_emplace(places, std::move(fresh)).first->second;
    return by_places_.try_emplace(places, deep).first->second;
  }
  Words structure;
  const std::vector<int>& contacts_early = fresh->permutation(Order::kContactsEarly);
  structure.reserve(2 + island.robots.size() + 3 * island.contacts.size() + contacts_early.size());
  add_structure(scene, island, structure);
  structure.insert(structure.end(), contacts_early.begin(), contacts_early.end());
  const auto& shape =
      shapes_.try_emplace(std::make_shared<const Words>(std::move(structure)), std::move(fresh)).first->second;
  return by_places_.try_emplace(places, shape).first->second;
}

void ShapeCache::keep(const std::set<const IslandShape*>& used) {
  for (auto* shapes : {&by_places_, &shapes_})
    std::erase_if(*shapes, [&used](const auto& item) { return !used.contains(item.second.get()); });
}

}  // namespace manycontact
