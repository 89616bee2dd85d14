#include "manycontact/kkt/pattern.hpp"

#include <algorithm>

#include "manycontact/sparse/ordering.hpp"

namespace manycontact {

std::string to_string(Order order) {
  switch (order) {
    case Order::kLeafToRoot: return "leaf-to-root";
    case Order::kContactsEarly: return "contacts-early";
    case Order::kCamd: return "camd";
  }
  return "?";
}

IslandSupport island_support(const Scene& scene, const Island& island) {
  IslandSupport s;
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    s.contacts.push_back(contact_support(scene, contact));
    std::vector<int> columns;
    const int a = island.dof_offset[local_robot(island, contact.A.robot)];
    for (int i : s.contacts.back().a) columns.push_back(a + i);
    if (contact.B.robot >= 0) {
      const int b = island.dof_offset[local_robot(island, contact.B.robot)];
      for (int i : s.contacts.back().b) columns.push_back(b + i);
    }
    s.columns.push_back(std::move(columns));
  }
  return s;
}

namespace {

using Entries = std::vector<std::pair<int, int>>;

// Entries of M in the order of the packed storage, then of J by columns, as (row, column) of K.
Entries inertia_entries(const Scene& scene, const Island& island) {
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

std::vector<int> leaf_to_root(const Scene& scene, const Island& island) {
  std::vector<int> perm;
  for (std::size_t r = 0; r < island.robots.size(); ++r)
    for (int i = scene.robots[island.robots[r]].model->nv - 1; i >= 0; --i) perm.push_back(island.dof_offset[r] + i);
  return perm;
}

// CAMD with the joints before the contacts.
std::vector<int> camd(const Island& island, const sparse::UpperCsc& K) {
  std::vector<int> set(island.size(), 0);
  std::fill(set.begin() + island.nv, set.end(), 1);
  return sparse::camd_order(K, set);
}

// A contact is ready once it finds as many eliminated coordinates of its own as it has rows; it uses them up.
std::vector<int> contacts_early(const Scene& scene, const Island& island, const IslandSupport& support) {
  const int ncontacts = static_cast<int>(island.contacts.size());
  std::vector<std::vector<int>> on_dof(island.nv);  // contacts that act on a coordinate
  for (int c = 0; c < ncontacts; ++c)
    for (int i : support.columns[c]) on_dof[i].push_back(c);
  std::vector<char> eliminated(island.nv, 0), used(island.nv, 0), placed(ncontacts, 0);
  std::vector<int> perm;
  const auto place = [&](int c) {
    const int first = island.nv + island.row_offset[c], rows = scene.contacts[island.contacts[c]].rows();
    for (int row = 0; row < rows; ++row) perm.push_back(first + row);
    placed[c] = 1;
  };
  for (int i : leaf_to_root(scene, island)) {
    perm.push_back(i);
    eliminated[i] = 1;
    for (int c : on_dof[i]) {
      if (placed[c]) continue;
      std::vector<int> available;
      for (int k : support.columns[c])
        if (eliminated[k] && !used[k]) available.push_back(k);
      const std::size_t rows = scene.contacts[island.contacts[c]].rows();
      if (available.size() < rows) continue;
      for (std::size_t k = 0; k < rows; ++k) used[available[k]] = 1;
      place(c);
    }
  }
  for (int c = 0; c < ncontacts; ++c)
    if (!placed[c]) place(c);
  return perm;
}

std::vector<int> elimination_order(const Scene& scene, const Island& island, const IslandSupport& support,
                                   const sparse::UpperCsc& K, Order order) {
  if (order == Order::kContactsEarly) return contacts_early(scene, island, support);
  std::vector<int> by_degree = camd(island, K);
  if (order == Order::kCamd) return by_degree;
  std::vector<int> perm = leaf_to_root(scene, island);
  for (int k : by_degree)  // among themselves the contacts go by degree
    if (k >= island.nv) perm.push_back(k);
  return perm;
}

}  // namespace

KktPattern analyze(const Scene& scene, const Island& island, const IslandSupport& support, Order order) {
  KktPattern p;
  p.nv = island.nv;
  p.nc = island.nc;
  p.order = order;
  const Entries M = inertia_entries(scene, island), J = contact_entries(scene, island, support);
  Entries all = M;
  all.insert(all.end(), J.begin(), J.end());
  const sparse::UpperCsc K = sparse::make_pattern(island.size(), std::move(all));
  p.perm = elimination_order(scene, island, support, K, order);
  p.iperm = sparse::inverse(p.perm);
  p.K = sparse::permute(K, p.iperm);
  const auto slot = [&p](const std::pair<int, int>& entry) {
    const auto [i, j] = std::minmax(p.iperm[entry.first], p.iperm[entry.second]);
    return p.K.slot(i, j);
  };
  for (const auto& entry : M) p.M_slot.push_back(slot(entry));
  for (const auto& entry : J) p.J_slot.push_back(slot(entry));
  for (int k = 0; k < island.nc; ++k) p.diagonal_slot.push_back(slot({island.nv + k, island.nv + k}));
  p.ldl = sparse::ldl_analyze(p.K);
  return p;
}

std::vector<long> shape_key(const Scene& scene, const Island& island, const IslandSupport& support) {
  std::vector<long> key;
  for (int r : island.robots) key.push_back(reinterpret_cast<long>(scene.robots[r].model.get()));
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    key.push_back(-scene.contacts[island.contacts[c]].rows());
    key.insert(key.end(), support.columns[c].begin(), support.columns[c].end());
  }
  return key;
}

}  // namespace manycontact
