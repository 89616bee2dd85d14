#include "manycontact/kkt/pattern.hpp"

#include <algorithm>

#include "manycontact/sparse/ordering.hpp"

namespace manycontact {

IslandSupport island_support(const Scene& scene, const Island& island) {
  IslandSupport s;
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    s.contacts.push_back(contact_support(scene, contact));
    std::vector<int> columns;
    const int a = first_dof(island, contact.A), b = first_dof(island, contact.B);
    for (int i : s.contacts.back().a) columns.push_back(a + i);
    for (int i : s.contacts.back().b) columns.push_back(b + i);
    s.columns.push_back(std::move(columns));
  }
  return s;
}

namespace {

using Entries = std::vector<std::pair<int, int>>;

Entries inertia_entries(const Scene& scene, const Island& island) {  // entries of M in K, in packed order
  Entries entries;
  for (std::size_t r = 0; r < island.robots.size(); ++r) {
    const Model& model = *scene.robots[island.robots[r]].model;
    const int o = island.dof_offset[r];
    for (int i = 0; i < model.nv; ++i)
      for (int j = i; j >= 0; j = model.dof_parent[j]) entries.emplace_back(o + i, o + j);
  }
  return entries;
}

Entries contact_entries(const Scene& scene, const Island& island, const IslandSupport& support) {
  Entries entries;
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const int first = island.nv + island.row_offset[c], rows = scene.contacts[island.contacts[c]].rows();
    for (int column : support.columns[c])
      for (int row = 0; row < rows; ++row) entries.emplace_back(first + row, column);
  }
  return entries;
}

}  // namespace

sparse::UpperCsc natural_pattern(const Scene& scene, const Island& island, const IslandSupport& support) {
  Entries all = inertia_entries(scene, island);
  const Entries J = contact_entries(scene, island, support);
  all.insert(all.end(), J.begin(), J.end());
  return sparse::make_pattern(island.size(), std::move(all));
}

const sparse::LdlSchedule& KktPattern::schedule() const {
  const std::lock_guard lock(lazy_schedule->mutex);
  auto& made = lazy_schedule->schedule;
  if (!made) made = std::make_unique<const sparse::LdlSchedule>(sparse::compile_ldl(K, ldl));
  return *made;
}

std::vector<char> robots_furthest_from_ground(const Scene& scene, const Island& island) {
  const std::size_t n = island.robots.size();
  std::vector<std::vector<int>> neighbours(n);
  std::vector<int> reached, distance(n, -1);
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    const int a = local_robot(island, robot_of(contact)),
              b = contact.B.robot < 0 ? a : local_robot(island, contact.B.robot);
    if (joins_robots(contact) && a != b) {
      neighbours[a].push_back(b), neighbours[b].push_back(a);
    } else if (!joins_robots(contact) && distance[a] < 0) {
      distance[a] = 0;
      reached.push_back(a);
    }
  }
  for (std::size_t next = 0; next < reached.size(); ++next)
    for (int r : neighbours[reached[next]])
      if (distance[r] < 0) distance[r] = distance[reached[next]] + 1, reached.push_back(r);
  std::vector<char> furthest(n, 0);
  for (int r : reached)
    furthest[r] = !neighbours[r].empty() && std::none_of(neighbours[r].begin(), neighbours[r].end(),
                                                         [&](int other) { return distance[other] > distance[r]; });
  return furthest;
}

std::vector<int> camd_order_from_ground(int n, std::vector<std::pair<int, int>> entries) {
  if (n == 0) return {};
  std::vector<int> last(static_cast<std::size_t>(n) + 1, 0);
  last.back() = 1;
  std::vector<int> order = sparse::camd_order(sparse::make_pattern(n + 1, std::move(entries)), last);
  order.pop_back();
  return order;
}

namespace {

// Returns K with one more row, which has entries in the joints of the robots furthest from the ground. Among otherwise
// equal orders, CAMD then eliminates a tower from the ground on, where constrained bodies are at rest. In an order from
// the free end on, the inertia of all bodies above a contact would be part of the contact's pivots.
sparse::UpperCsc with_row_of_furthest(const Scene& scene, const Island& island, const sparse::UpperCsc& K) {
  const std::vector<char> furthest = robots_furthest_from_ground(scene, island);
  sparse::UpperCsc out = K;
  ++out.n;
  for (std::size_t r = 0; r < furthest.size(); ++r) {
    const int nv = scene.robots[island.robots[r]].model->nv;
    for (int i = 0; furthest[r] && i < nv; ++i) out.i.push_back(island.dof_offset[r] + i);
  }
  out.i.push_back(K.n);
  out.p.push_back(out.nonzeros());
  return out;
}

}  // namespace

// Implements Order::kCamd: CAMD's order with the constraint that joints are eliminated before contacts.
std::vector<int> camd_order(const Scene& scene, const Island& island, const sparse::UpperCsc& K) {
  if (island.nv == 0) return sparse::camd_order(K, {});  // CAMD refuses constraint sets if the first set is empty
  std::vector<int> set(island.size(), 0);
  std::fill(set.begin() + island.nv, set.end(), 1);
  if (island.robots.size() <= 2) return sparse::camd_order(K, set);
  set.push_back(island.nc > 0 ? 2 : 1);
  std::vector<int> order = sparse::camd_order(with_row_of_furthest(scene, island, K), set);
  order.pop_back();
  return order;
}

std::vector<int> leaf_to_root_order(const Scene& scene, const Island& island, const std::vector<int>& by_degree) {
  std::vector<int> perm;
  for (std::size_t r = 0; r < island.robots.size(); ++r)
    for (int i = scene.robots[island.robots[r]].model->nv - 1; i >= 0; --i) perm.push_back(island.dof_offset[r] + i);
  for (int k : by_degree)
    if (k >= island.nv) perm.push_back(k);
  return perm;
}

KktPattern analyze(const Scene& scene, const Island& island, const IslandSupport& support, const sparse::UpperCsc& K,
                   Order order, std::vector<int> perm) {
  KktPattern p;
  p.nv = island.nv;
  p.nc = island.nc;
  p.order = order;
  p.perm = std::move(perm);
  p.iperm = sparse::inverse(p.perm);
  for (int row : p.perm) p.of_M.push_back(row < p.nv);
  p.K = sparse::permute(K, p.iperm);
  const auto slot = [&p](const std::pair<int, int>& entry) {
    const auto [i, j] = std::minmax(p.iperm[entry.first], p.iperm[entry.second]);
    return p.K.slot(i, j);
  };
  const auto slots = [&slot](const Entries& entries) {
    std::vector<int> out(entries.size());
    std::transform(entries.begin(), entries.end(), out.begin(), slot);
    return out;
  };
  p.M_slot = slots(inertia_entries(scene, island));
  p.J_slot = slots(contact_entries(scene, island, support));
  for (int k = 0; k < island.nc; ++k) p.diagonal_slot.push_back(slot({island.nv + k, island.nv + k}));
  if (!too_full_for_sparse(island)) p.ldl = sparse::ldl_analyze(p.K);
  return p;
}

}  // namespace manycontact
