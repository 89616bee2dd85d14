// The order contacts-early eliminates a contact as soon as the joints eliminated before it give its rows sound pivots.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/kkt/choose.hpp"
#include "manycontact/sparse/decompositions.hpp"
#include "manycontact/sparse/ordering.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "manycontact/sparse/union_find.hpp"

namespace manycontact {

namespace {

// Returns J per contact in a configuration without symmetry: each coordinate is neutral + `mean` +- up to `most`. Bases
// are at the world's origin: equal islands get equal orders. other: phase between successive robots' deviations.
std::vector<Eigen::MatrixXd> jacobians_at(const Scene& scene, const Island& island, const IslandSupport& support,
                                          double mean, double most, double other) {
  std::vector<Eigen::MatrixXd> J;
  std::vector<Kinematics<double>> kin;
  for (std::size_t r = 0; r < island.robots.size(); ++r) {
    const Model& model = *scene.robots[island.robots[r]].model;
    Eigen::VectorXd step(model.nv), q(model.nq);
    for (int i = 0; i < model.nv; ++i) step[i] = mean + most * std::sin(1 + 7.0 * i + other * static_cast<double>(r));
    integrate<double>(model, neutral(model), step, q);
    kin.emplace_back(model);
    forward_kinematics<double>(model, {}, q, kin.back());
    forward_accelerations<double>(model, Eigen::VectorXd::Zero(model.nv), nullptr, scene.gravity, kin.back());
  }
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[island.contacts[c]];
    ContactData<double> data(contact, support.contacts[c]);
    contact_rows<double>(scene, contact, support.contacts[c], kin[local_robot(island, robot_of(contact))],
                         contact.B.robot < 0 ? nullptr : &kin[local_robot(island, contact.B.robot)], data);
    J.push_back(std::move(data.J));
  }
  return J;
}

// Scales J's rows to unit length, so that the contributions of some of the coordinates are relative to the whole row.
std::vector<Eigen::MatrixXd> of_unit_rows(std::vector<Eigen::MatrixXd> J) {
  for (Eigen::MatrixXd& rows : J)
    for (auto row : rows.rowwise())
      if (const double length = row.norm(); length > 0) row /= length;
  return J;
}

// Returns the robots in an order of minimum degree in the graph whose edges are contacts, so that each robot is coupled
// to few others when it is eliminated. Robots furthest from the ground get one more edge, to a node that comes last, so
// that a tower is eliminated from its grounded end on (pattern.cpp).
std::vector<int> robots_by_degree(const Scene& scene, const Island& island) {
  const int n = static_cast<int>(island.robots.size());
  std::vector<std::pair<int, int>> joined;
  for (int c : island.contacts)
    if (const Contact& contact = scene.contacts[c]; joins_robots(contact))
      joined.emplace_back(local_robot(island, contact.A.robot), local_robot(island, contact.B.robot));
  const std::vector<char> furthest = robots_furthest_from_ground(scene, island);
  for (int r = 0; r < n; ++r)
    if (furthest[r]) joined.emplace_back(r, n);
  return camd_order_from_ground(n, std::move(joined));
}

// Clusters of bodies that contacts of six rows already in the order fix to each other. Elimination leaves nothing of
// the rows of another contact within a cluster, so it need not wait for coordinates.
class Clusters {
 public:
  Clusters(const Scene& scene, const Island& island) : scene_(scene), island_(island), first_{1} {
    for (int r : island.robots) first_.push_back(first_.back() + scene.robots[r].model->njoints());
    memory_.resize(first_.back());
    sets_.emplace(memory_);
    touching_.resize(first_.back());
    for (std::size_t c = 0; c < island.contacts.size(); ++c)
      for (int body : ends(static_cast<int>(c)))
        if (body != kWorld) touching_[body].push_back(static_cast<int>(c));
  }

  /// Call it with c now in the order. Calls use(contact) for contacts between clusters that c unites; they may follow.
  template <class Use>
  void fix(int c, Use&& use) {
    if (scene_.contacts[island_.contacts[c]].rows() < 6) return;
    const auto [A, B] = ends(c);
    int a = sets_->root(A), b = sets_->root(B);
    if (a == b) return;
    if (touching_[a].size() < touching_[b].size()) std::swap(a, b);
    std::vector<int> few = std::move(touching_[b]), many = std::move(touching_[a]);
    sets_->join(a, b);
    const int joined = sets_->root(a);
    for (int other : few) {
      const auto [from, to] = ends(other);
      if (sets_->root(from) == sets_->root(to)) use(other);
    }
    many.insert(many.end(), few.begin(), few.end());
    touching_[joined] = std::move(many);
  }

 private:
  static constexpr int kWorld = 0;
  int body(const Attachment& end) const {
    return moves(end) ? first_[local_robot(island_, end.robot)] + end.joint : kWorld;
  }
  std::array<int, 2> ends(int c) const {
    const Contact& contact = scene_.contacts[island_.contacts[c]];
    return {body(contact.A), body(contact.B)};
  }

  const Scene& scene_;
  const Island& island_;
  std::vector<int> first_;  // first body of each robot; the world is body 0
  std::vector<int> memory_;
  std::optional<sparse::UnionFind> sets_;
  std::vector<std::vector<int>> touching_;  // contacts on the bodies of a cluster, one list per root of a cluster
};

// Whether both ends of a contact are on one robot, so that it closes a loop.
bool closes_loop(const Contact& contact) { return moves(contact.B) && contact.A.robot == contact.B.robot; }

// Returns the order of all rows of K, given that of the robots. A contact enters it when eliminated coordinates that no
// other contact has used up move it in as many directions as it has rows, by at least `distinct` in all configurations;
// it then uses up those that move it best. A contact that closes a loop enters after its last coordinate, as
// independent rows then have sound pivots in every configuration. J: unit rows per configuration and contact.
std::vector<int> with_contacts(const Scene& scene, const Island& island, const IslandSupport& support,
                               const std::vector<std::vector<Eigen::MatrixXd>>& J, const std::vector<int>& robots,
                               double distinct) {
  const int ncontacts = static_cast<int>(island.contacts.size());
  std::vector<std::vector<int>> on_dof(island.nv);  // one entry per coordinate: contacts that act on it
  for (int c = 0; c < ncontacts; ++c)
    for (int i : support.columns[c]) on_dof[i].push_back(c);
  std::vector<char> eliminated(island.nv, 0), used(island.nv, 0), placed(ncontacts, 0);
  std::vector<int> perm;
  Clusters clusters(scene, island);
  const auto place = [&](int c) {
    if (std::exchange(placed[c], 1)) return;
    const int first = island.nv + island.row_offset[c], rows = scene.contacts[island.contacts[c]].rows();
    for (int row = 0; row < rows; ++row) perm.push_back(first + row);
  };
  const auto eliminate = [&](int i) {
    perm.push_back(i);
    eliminated[i] = 1;
    for (int c : on_dof[i]) {
      if (placed[c]) continue;
      const std::vector<int>& columns = support.columns[c];
      const bool loop = closes_loop(scene.contacts[island.contacts[c]]);
      if (loop && !std::ranges::all_of(columns, [&](int k) { return eliminated[k] != 0; })) continue;
      std::vector<int> available;  // columns of J whose coordinates are eliminated and not used up
      for (std::size_t k = 0; k < columns.size(); ++k)
        if (eliminated[columns[k]] && !used[columns[k]]) available.push_back(static_cast<int>(k));
      const Eigen::Index rows = J.front()[c].rows(), most = static_cast<Eigen::Index>(available.size());
      if (!loop && most < rows) continue;
      std::vector<int> best;
      const bool ready =
          most == 0 || std::all_of(J.begin(), J.end(), [&](const std::vector<Eigen::MatrixXd>& of_posture) {
            const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(of_posture[c](Eigen::all, available));
            for (Eigen::Index k = 0; std::ssize(best) < std::min(rows, most); ++k)
              best.push_back(columns[available[qr.colsPermutation().indices()[k]]]);
            return loop || std::abs(qr.matrixQR()(rows - 1, rows - 1)) > distinct;
          });
      if (!ready) continue;
      for (int column : best) used[column] = 1;
      place(c);
      clusters.fix(c, place);
    }
  };
  for (int r : robots)
    for (int i = scene.robots[island.robots[r]].model->nv - 1; i >= 0; --i) eliminate(island.dof_offset[r] + i);
  for (int c = 0; c < ncontacts; ++c) place(c);
  return perm;
}

double cost(const sparse::UpperCsc& K, const std::vector<int>& perm) {
  return predicted_cost_ldl(K.n, sparse::ldl_count(sparse::permute(K, sparse::inverse(perm))));
}

}  // namespace

std::vector<int> contacts_early_order(const Scene& scene, const Island& island, const IslandSupport& support,
                                      const sparse::UpperCsc& K) {
  if (island.contacts.empty()) return leaf_to_root_order(scene, island, {});
  std::vector<std::vector<Eigen::MatrixXd>> J;  // one entry per configuration; legs are nearly straight in the last one
  for (const auto& [mean, most] : {std::pair(0.3, 0.2), std::pair(0.0, 0.2), std::pair(0.0, 0.02)})
    J.push_back(of_unit_rows(jacobians_at(scene, island, support, mean, most, 3)));
  std::vector<std::vector<int>> orders(1);  // orders of robots: by number, and by degree
  orders[0].resize(island.robots.size());
  std::iota(orders[0].begin(), orders[0].end(), 0);
  if (island.robots.size() > 2) orders.push_back(robots_by_degree(scene, island));
  std::vector<int> best;
  double least = std::numeric_limits<double>::infinity();
  for (const double distinct : tolerance::kDistinct)
    for (const std::vector<int>& robots : orders) {
      std::vector<int> perm = with_contacts(scene, island, support, J, robots, distinct);
      const double of_perm = cost(K, perm), most = &robots == &orders[0] ? least : tolerance::kCheaper * least;
      if (of_perm < most) best = std::move(perm), least = of_perm;
    }
  return best;
}

}  // namespace manycontact
