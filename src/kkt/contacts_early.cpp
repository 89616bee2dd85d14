// The order contacts-early: a contact as soon as the joints below it give it its pivots.

#include <Eigen/QR>
#include <cmath>
#include <numeric>

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/kkt/pattern.hpp"
#include "manycontact/sparse/ordering.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

namespace {

// The contacts' J at a configuration without symmetry, to see which coordinates move them in which directions. Rows of
// unit length: what coordinates give a row is judged beside all that moves it.
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
    for (auto row : data.J.rowwise())
      if (const double length = row.norm(); length > 0) row /= length;
    J.push_back(std::move(data.J));
  }
  return J;
}

// Robots by degree in the graph of those that contacts join: each is joined to few others when its turn comes.
std::vector<int> robots_by_degree(const Scene& scene, const Island& island) {
  std::vector<std::pair<int, int>> joined;
  for (int c : island.contacts)
    if (const Contact& contact = scene.contacts[c]; joins_robots(contact))
      joined.emplace_back(local_robot(island, contact.A.robot), local_robot(island, contact.B.robot));
  return sparse::camd_order(sparse::make_pattern(static_cast<int>(island.robots.size()), std::move(joined)), {});
}

// A contact is ready once the eliminated coordinates of its own, not yet used up by another, move it in as many
// directions as it has rows; it uses up those that do it best.
std::vector<int> with_contacts(const Scene& scene, const Island& island, const IslandSupport& support,
                               const std::vector<Eigen::MatrixXd>& J, const std::vector<int>& robots) {
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
  const auto eliminate = [&](int i) {
    perm.push_back(i);
    eliminated[i] = 1;
    for (int c : on_dof[i]) {
      if (placed[c]) continue;
      std::vector<int> available;  // columns of J
      for (std::size_t k = 0; k < support.columns[c].size(); ++k)
        if (eliminated[support.columns[c][k]] && !used[support.columns[c][k]]) available.push_back(static_cast<int>(k));
      const Eigen::Index rows = J[c].rows();
      if (static_cast<Eigen::Index>(available.size()) < rows) continue;
      const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(J[c](Eigen::all, available));
      if (!(std::abs(qr.matrixQR()(rows - 1, rows - 1)) > tolerance::kDistinct)) continue;
      for (Eigen::Index k = 0; k < rows; ++k)
        used[support.columns[c][available[qr.colsPermutation().indices()[k]]]] = 1;
      place(c);
    }
  };
  for (int r : robots)
    for (int i = scene.robots[island.robots[r]].model->nv - 1; i >= 0; --i) eliminate(island.dof_offset[r] + i);
  for (int c = 0; c < ncontacts; ++c)
    if (!placed[c]) place(c);
  return perm;
}

}  // namespace

std::vector<int> contacts_early_order(const Scene& scene, const Island& island, const IslandSupport& support,
                                      const sparse::UpperCsc& K) {
  const std::vector<Eigen::MatrixXd> J = sample_jacobians(scene, island, support);
  std::vector<int> robots(island.robots.size());
  std::iota(robots.begin(), robots.end(), 0);
  std::vector<int> perm = with_contacts(scene, island, support, J, robots);
  if (robots.size() < 3) return perm;
  std::vector<int> by_degree = with_contacts(scene, island, support, J, robots_by_degree(scene, island));
  const auto flops = [&](const std::vector<int>& p) {
    return sparse::ldl_count(sparse::permute(K, sparse::inverse(p))).flops;
  };
  return flops(by_degree) < tolerance::kCheaper * flops(perm) ? by_degree : perm;
}

}  // namespace manycontact
