#include "manycontact/kkt/schur.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "manycontact/algorithm/inertia_factor.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

namespace {

// Lists the contacts that act on each robot, for SchurPattern::robots.
std::vector<SchurPattern::OnRobot> contacts_on_robots(const Scene& scene, const Island& island,
                                                      const IslandSupport& support) {
  std::vector<SchurPattern::OnRobot> robots(island.robots.size());
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[island.contacts[c]];
    const auto act = [&](int robot) {
      SchurPattern::OnRobot& on = robots[local_robot(island, robot)];
      on.contacts.push_back(static_cast<int>(c));
      on.first_row.push_back(on.rows);
      on.rows += contact.rows();
    };
    const bool on_b = contact.B.robot >= 0 && !support.contacts[c].b.empty();
    if (!support.contacts[c].a.empty() || (on_b && contact.A.robot == contact.B.robot)) act(contact.A.robot);
    if (on_b && contact.B.robot != contact.A.robot) act(contact.B.robot);
  }
  return robots;
}

}  // namespace

SchurCounts count_schur(const Scene& scene, const Island& island, const IslandSupport& support) {
  const auto pairs = [](double rows) { return rows * (rows + 1) / 2; };
  SchurCounts counts;
  std::vector<std::vector<int>> on(island.contacts.size());  // robots that a contact acts on
  for (const SchurPattern::OnRobot& robot : contacts_on_robots(scene, island, support)) {
    for (int c : robot.contacts) on[c].push_back(static_cast<int>(counts.rows.size()));
    counts.rows.push_back(robot.rows);
    counts.nonzeros += pairs(robot.rows);  // any two of its rows
  }
  std::map<std::pair<int, int>, int> joined;  // rows that act on both of two robots, whose pairs were counted twice
  for (std::size_t c = 0; c < on.size(); ++c) {
    const int rows = scene.contacts[island.contacts[c]].rows();
    if (on[c].size() == 2) joined[{on[c][0], on[c][1]}] += rows;
    if (on[c].empty()) counts.nonzeros += rows;  // the diagonal
  }
  for (const auto& [robots, rows] : joined) counts.nonzeros -= pairs(rows);
  return counts;
}

SchurPattern analyze_schur(const Scene& scene, const Island& island, const IslandSupport& support) {
  SchurPattern p;
  p.robots = contacts_on_robots(scene, island, support);
  p.J_first.assign(1, 0);
  for (std::size_t c = 0; c < island.contacts.size(); ++c)
    p.J_first.push_back(p.J_first.back() + scene.contacts[island.contacts[c]].rows() * support.contacts[c].cols());
  // rows of S that a robot's rows are
  std::vector<std::vector<int>> rows(p.robots.size());
  std::vector<std::pair<int, int>> entries;
  for (std::size_t r = 0; r < p.robots.size(); ++r) {
    for (int c : p.robots[r].contacts)
      for (int k = 0; k < scene.contacts[island.contacts[c]].rows(); ++k) rows[r].push_back(island.row_offset[c] + k);
    for (std::size_t j = 0; j < rows[r].size(); ++j)
      for (std::size_t i = 0; i <= j; ++i) entries.emplace_back(rows[r][i], rows[r][j]);
  }
  p.S = sparse::make_pattern(island.nc, std::move(entries));
  for (const auto& on : rows)
    for (std::size_t j = 0; j < on.size(); ++j)
      for (std::size_t i = 0; i <= j; ++i) p.slot.push_back(p.S.slot(std::min(on[i], on[j]), std::max(on[i], on[j])));
  return p;
}

namespace {

// Z <- J^T on one robot: the contacts' columns on it, transposed into place.
void gather_rows(const Scene& scene, const Island& island, const IslandSupport& support, int r,
                 const SchurPattern& pattern, std::span<const double> J, Eigen::MatrixXd& Z) {
  const SchurPattern::OnRobot& on = pattern.robots[r];
  Z.setZero();
  const int first = island.dof_offset[r], end = first + static_cast<int>(Z.rows());
  for (std::size_t k = 0; k < on.contacts.size(); ++k) {
    const int c = on.contacts[k], rows = scene.contacts[island.contacts[c]].rows();
    const std::vector<int>& columns = support.columns[c];
    for (std::size_t j = 0; j < columns.size(); ++j) {
      if (columns[j] < first || columns[j] >= end) continue;
      for (int row = 0; row < rows; ++row)
        Z(columns[j] - first, on.first_row[k] + row) = J[pattern.J_first[c] + j * rows + row];
    }
  }
}

}  // namespace

bool form_schur(const Scene& scene, const Island& island, const IslandSupport& support, const SchurPattern& pattern,
                std::span<const double> M, std::span<const double> J, double delta, SchurData& data) {
  const std::size_t n = island.robots.size();
  data.L.resize(n);
  data.scratch.resize(island.nv);
  data.Z.resize(n);
  data.Sx.assign(pattern.S.nonzeros(), 0.0);
  const int* slot = pattern.slot.data();
  for (std::size_t r = 0; r < n; ++r) {
    const Model& model = *scene.robots[island.robots[r]].model;
    const std::span<const double> own = M.first(model.M_begin[model.nv]);
    M = M.subspan(own.size());
    data.L[r].assign(own.begin(), own.end());
    if (!factorize_inertia(model, data.L[r].data(), data.scratch.data(), tolerance::kPivotLeft).empty()) return false;
    const SchurPattern::OnRobot& on = pattern.robots[r];
    Eigen::MatrixXd& Z = data.Z[r];
    Z.resize(model.nv, on.rows);
    gather_rows(scene, island, support, static_cast<int>(r), pattern, J, Z);
    for (int c = 0; c < on.rows; ++c) solve_inertia_transposed(model, data.L[r].data(), 1, Z.col(c).data());
    for (int i = 0; i < model.nv; ++i) Z.row(i) /= std::sqrt(data.L[r][model.M_begin[i]]);
    for (int j = 0; j < on.rows; ++j)  // S += Z^T Z with Z = D^-1/2 L^-T J^T
      for (int i = 0; i <= j; ++i) data.Sx[*slot++] += Z.col(i).dot(Z.col(j));
  }
  for (int k = 0; k < island.nc; ++k) data.Sx[pattern.S.p[k + 1] - 1] += delta;
  return true;
}

}  // namespace manycontact
