#include "interface.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "manycontact/sparse/ordering.hpp"
#include "manycontact/sparse/relaxed_supernodes.hpp"

namespace manycontact {

namespace {

// Lists each contact with its robot, or with the two robots that the contact couples.
void share_out(const Scene& scene, const Island& island, Interface& j) {
  std::vector<int> first(island.contacts.size());  // each contact's first interface row
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[island.contacts[c]];
    const int number = static_cast<int>(c);
    if (!joins_two(contact)) {
      j.robots[local_robot(island, robot_of(contact))].contacts.push_back(number);
      continue;
    }
    const int a = local_robot(island, contact.A.robot), b = local_robot(island, contact.B.robot);
    for (const auto& [at, other] : {std::pair(a, b), std::pair(b, a)}) {
      Interface::OfRobot& r = j.robots[at];
      r.joins.push_back(number);
      if (std::find(r.neighbours.begin(), r.neighbours.end(), other) == r.neighbours.end())
        r.neighbours.push_back(other);
    }
    first[c] = j.rows();
    for (int i = 0; i < contact.rows(); ++i) j.row.push_back(island.nv + island.row_offset[c] + i);
  }
  for (std::size_t k = 0; k < j.robots.size(); ++k) {
    Interface::OfRobot& r = j.robots[k];
    const auto place = [&](int c) {  // so that robots of one kind order their contacts identically
      const Contact& contact = scene.contacts[island.contacts[c]];
      return std::tuple(kind_of(contact), end_on(contact, island.robots[k]).joint, c);
    };
    std::sort(r.joins.begin(), r.joins.end(), [&](int x, int y) { return place(x) < place(y); });
    for (int c : r.joins)
      for (int i = 0; i < scene.contacts[island.contacts[c]].rows(); ++i) r.interface_rows.push_back(first[c] + i);
  }
}

void analyze_interface(const IslandShape& shape, Interface& interface) {
  std::vector<std::pair<int, int>> entries;
  const auto each_entry = [&interface](auto&& use) {
    for (Interface::OfRobot& r : interface.robots)
      for (std::size_t j = 0; j < r.interface_rows.size(); ++j)
        for (std::size_t i = 0; i <= j; ++i) use(r, r.interface_rows[i], r.interface_rows[j]);
  };
  each_entry([&](Interface::OfRobot&, int i, int j) { entries.emplace_back(i, j); });
  const sparse::UpperCsc pattern = sparse::make_pattern(interface.rows(), entries);
  const std::vector<char> furthest = robots_furthest_from_ground(shape.scene(), shape.island());
  for (std::size_t k = 0; k < interface.robots.size(); ++k)
    for (int row : interface.robots[k].interface_rows)
      if (furthest[k]) entries.emplace_back(row, interface.rows());
  interface.perm = camd_order_from_ground(interface.rows(), std::move(entries));
  interface.place = sparse::inverse(interface.perm);
  interface.S = sparse::permute(pattern, interface.place);
  sparse::LdlSymbolic L = sparse::ldl_analyze(interface.S);
  sparse::relax_supernodes(L);
  interface.flops = L.flops;
  interface.schedule = sparse::compile_ldl(interface.S, L);
  const std::vector<int>& at = interface.place;
  each_entry([&](Interface::OfRobot& r, int i, int j) {
    r.slot.push_back(interface.S.slot(std::min(at[i], at[j]), std::max(at[i], at[j])));
  });
}

}  // namespace

sparse::LdlCounts least_interface_counts(const IslandShape& shape) {
  const auto pairs = [](double rows) { return rows * (rows - 1) / 2; };
  std::vector<double> of_robot(shape.island().robots.size(), 0.0);
  std::map<std::pair<int, int>, double> of_two;  // rows between two robots, counted for both in of_robot
  for (const Contact& contact : shape.scene().contacts) {
    if (!joins_two(contact)) continue;
    const auto [a, b] = std::minmax(contact.A.robot, contact.B.robot);
    for (double* rows : {&of_robot[a], &of_robot[b], &of_two[{a, b}]}) *rows += contact.rows();
  }
  sparse::LdlCounts least;
  double most = 0;
  for (double rows : of_robot) least.nonzeros += pairs(rows), most = std::max(most, rows);
  for (const auto& [robots, rows] : of_two) least.nonzeros -= pairs(rows);
  for (double below = most - 1; below > 0; --below) least.flops += below * (below + 2);  // the robot with most rows
  return least;
}

Interface::Interface(const IslandShape& shape) : robots(shape.island().robots.size()) {
  share_out(shape.scene(), shape.island(), *this);
  analyze_interface(shape, *this);
}

}  // namespace manycontact
