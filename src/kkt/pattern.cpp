#include "manycontact/kkt/pattern.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/kkt/overdetermined.hpp"
#include "manycontact/sparse/ordering.hpp"
#include "manycontact/sparse/tolerances.hpp"

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
  if (island.nv == 0)
    return sparse::camd_order(K, {});  // CAMD does not take a set that is all there is but not the first
  std::vector<int> set(island.size(), 0);
  std::fill(set.begin() + island.nv, set.end(), 1);
  return sparse::camd_order(K, set);
}

// The contacts' J at a configuration without symmetry, to see which coordinates move them in which directions.
std::vector<Eigen::MatrixXd> sample_jacobians(const Scene& scene, const Island& island, const IslandSupport& support) {
  std::vector<Kinematics<double>> kin;
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    const Model& model = *robot.model;
    Eigen::VectorXd step(model.nv), q(model.nq);
    for (int i = 0; i < model.nv; ++i) step[i] = 0.3 + 0.2 * std::sin(1 + 7 * i);
    integrate<double>(model, neutral(model), step, q);
    kin.emplace_back(model);
    // whatever the base: the posture has no symmetry as it is, and alike islands see the same
    forward_kinematics<double>(model, {}, q, kin.back());
    forward_accelerations<double>(model, Eigen::VectorXd::Zero(model.nv), nullptr, scene.gravity, kin.back());
  }
  std::vector<Eigen::MatrixXd> J;
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[island.contacts[c]];
    ContactData<double> data(contact, support.contacts[c]);
    contact_rows<double>(scene, contact, support.contacts[c], kin[local_robot(island, robot_of(contact))],
                         contact.B.robot < 0 ? nullptr : &kin[local_robot(island, contact.B.robot)], data);
    J.push_back(data.J);
  }
  return J;
}

// A contact is ready once the eliminated coordinates of its own, not yet used up by another, move it in as many
// directions as it has rows; it uses up those that do it best.
std::vector<int> contacts_early(const Scene& scene, const Island& island, const IslandSupport& support) {
  const int ncontacts = static_cast<int>(island.contacts.size());
  const std::vector<Eigen::MatrixXd> J = sample_jacobians(scene, island, support);
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
      std::vector<int> available;  // columns of J
      for (std::size_t k = 0; k < support.columns[c].size(); ++k)
        if (eliminated[support.columns[c][k]] && !used[support.columns[c][k]]) available.push_back(static_cast<int>(k));
      if (static_cast<Eigen::Index>(available.size()) < J[c].rows()) continue;
      Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
      qr.setThreshold(tolerance::kDistinct);
      qr.compute(J[c](Eigen::all, available));
      if (qr.rank() < J[c].rows()) continue;
      for (Eigen::Index k = 0; k < qr.rank(); ++k)
        used[support.columns[c][available[qr.colsPermutation().indices()[k]]]] = 1;
      place(c);
    }
  }
  for (int c = 0; c < ncontacts; ++c)
    if (!placed[c]) place(c);
  return perm;
}

// M's pattern and J's.
sparse::UpperCsc whole_pattern(const Scene& scene, const Island& island, const IslandSupport& support) {
  Entries all = inertia_entries(scene, island);
  const Entries J = contact_entries(scene, island, support);
  all.insert(all.end(), J.begin(), J.end());
  return sparse::make_pattern(island.size(), std::move(all));
}

}  // namespace

const sparse::LdlSchedule& KktPattern::schedule() const {
  const std::lock_guard lock(lazy_schedule->mutex);
  auto& made = lazy_schedule->schedule;
  if (!made) made = std::make_unique<const sparse::LdlSchedule>(sparse::compile_ldl(K, ldl));
  return *made;
}

std::vector<int> elimination_order(const Scene& scene, const Island& island, const IslandSupport& support,
                                   Order order) {
  if (order == Order::kContactsEarly) return contacts_early(scene, island, support);
  std::vector<int> by_degree = camd(island, whole_pattern(scene, island, support));
  if (order == Order::kCamd) return by_degree;
  std::vector<int> perm = leaf_to_root(scene, island);
  for (int k : by_degree)  // among themselves the contacts go by degree
    if (k >= island.nv) perm.push_back(k);
  return perm;
}

KktPattern analyze(const Scene& scene, const Island& island, const IslandSupport& support, Order order,
                   std::vector<int> perm) {
  KktPattern p;
  p.nv = island.nv;
  p.nc = island.nc;
  p.order = order;
  p.perm = std::move(perm);
  p.iperm = sparse::inverse(p.perm);
  p.K = sparse::permute(whole_pattern(scene, island, support), p.iperm);
  const auto slot = [&p](const std::pair<int, int>& entry) {
    const auto [i, j] = std::minmax(p.iperm[entry.first], p.iperm[entry.second]);
    return p.K.slot(i, j);
  };
  for (const auto& entry : inertia_entries(scene, island)) p.M_slot.push_back(slot(entry));
  for (const auto& entry : contact_entries(scene, island, support)) p.J_slot.push_back(slot(entry));
  for (int k = 0; k < island.nc; ++k) p.diagonal_slot.push_back(slot({island.nv + k, island.nv + k}));
  if (!too_full_for_sparse(island)) p.ldl = sparse::ldl_analyze(p.K);
  return p;
}

}  // namespace manycontact
