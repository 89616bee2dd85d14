#include "manycontact/analysis/rank_changes.hpp"

#include <algorithm>
#include <stdexcept>

#include "at_rest.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact {

namespace {

constexpr int kRankProbes = 2;
constexpr double kNoChange = 1e-8;   // smaller values of n^T dJ[z] y, relative to its terms, are rounding errors
constexpr int kFactors = 3;          // number of factors of n^T dJ[z] y, each of which an error of J may change
constexpr double kNoMotion = 1e-9;   // smaller projections on J v = 0, relative to the projected vector, are no motion
constexpr double kMostLooked = 1e5;  // largest contacts times coordinates for which RankChange::coordinate is found

// Test vectors for all islands at once: n_ in the null space of J^T, z_ an allowed motion, y_ any motion. dJ[z] is the
// derivative of J in the direction z; the rank of J changes where n^T dJ[z] y is not zero.
class Probe {
 public:
  Probe(const Scene& scene, const SceneData& data, const Eigen::VectorXd& q, internal::AtRest& rest, int number)
      : scene_(scene), data_(data), q_(q), rest_(rest) {
    n_ = rest.null_component(q, internal::mixed(data.f.size(), number));
    const Eigen::VectorXd w = internal::mixed(scene.nv, number + 7);
    z_ = rest.allowed_part(q, w);
    y_ = internal::mixed(scene.nv, number + 11);
    zz_ = rest.bias(q, z_);
    plus_ = rest.bias(q, z_ + y_);
    minus_ = rest.bias(q, z_ - y_);
    terms_ = rest.bias_terms(q, z_ + y_) + rest.bias_terms(q, z_ - y_);
    change_ = rest.change_of_null(q, inaccuracy_of(scene, data));
  }

  bool moves(std::size_t island) const {
    double largest = 0;
    internal::each_coordinate(scene_, data_, island, [&](int i) { largest = std::max(largest, std::abs(z_[i])); });
    return largest > kNoMotion;
  }
  bool singular(std::size_t island) const { return counts(island, zz_); }
  bool changes_beside(std::size_t island) const { return counts(island, plus_ - minus_); }

  std::vector<int> contacts(std::size_t island) const {
    std::vector<int> out;
    const double least = kNoChange * largest_of_n(island);
    for (const int c : solved_island(data_, island).contacts) {
      const auto of_contact = n_.segment(data_.f_offset[c], scene_.contacts[c].rows());
      if (of_contact.cwiseAbs().maxCoeff() > least) out.push_back(c);
    }
    return out;
  }
  // Returns for each island the coordinate that contributes most to n^T dJ[z] z if the configuration is singular,
  // otherwise the coordinate of the largest entry of n^T dJ[z]. Step k examines the k-th coordinate of all islands.
  std::vector<int> coordinates(const std::vector<std::size_t>& islands) const {
    std::vector<std::vector<int>> of(islands.size());
    std::size_t most = 0;
    for (std::size_t k = 0; k < islands.size(); ++k) {
      const double nv = solved_island(data_, islands[k]).nv;
      if (nv * static_cast<double>(scene_.contacts.size()) > kMostLooked) continue;
      internal::each_coordinate(scene_, data_, islands[k], [&](int i) { of[k].push_back(i); });
      most = std::max(most, of[k].size());
    }
    std::vector<int> out(islands.size(), -1);
    std::vector<double> largest(islands.size(), 0);
    for (std::size_t step = 0; step < most; ++step) {
      Eigen::VectorXd e = Eigen::VectorXd::Zero(scene_.nv);
      for (const std::vector<int>& own : of)
        if (step < own.size()) e[own[step]] = 1;
      const Eigen::VectorXd change = rest_.bias(q_, z_ + e) - rest_.bias(q_, z_ - e);
      for (std::size_t k = 0; k < islands.size(); ++k) {
        if (step >= of[k].size()) continue;
        const int i = of[k][step];
        const double b = std::abs(product(islands[k], change)) * (singular(islands[k]) ? std::abs(z_[i]) : 1);
        if (b > largest[k]) largest[k] = b, out[k] = i;
      }
    }
    return out;
  }

 private:
  double product(std::size_t island, const Eigen::VectorXd& b) const {
    double sum = 0;
    internal::each_row(scene_, data_, island, [&](int row) { sum += n_[row] * b[row]; });
    return sum;
  }
  double largest_of_n(std::size_t island) const {
    double largest = 0;
    internal::each_row(scene_, data_, island, [&](int row) { largest = std::max(largest, std::abs(n_[row])); });
    return largest;
  }
  bool counts(std::size_t island, const Eigen::VectorXd& b) const {
    double size = 0, terms = 0;
    internal::each_row(scene_, data_, island, [&](int row) {
      size += std::abs(n_[row]) * terms_[row];
      terms = std::max(terms, terms_[row]);
    });
    const double changed = kFactors * internal::change_in(scene_, data_, island, n_, change_) * terms;
    return std::abs(product(island, b)) > kNoChange * size + changed;
  }

  const Scene& scene_;
  const SceneData& data_;
  const Eigen::VectorXd& q_;
  internal::AtRest& rest_;
  // zz_: dJ[z] z; plus_ and minus_: Jdot v for v = z + y and for v = z - y; terms_: bias_terms of AtRest, the magnitude
  // of these vectors' terms; change_: change_of_null of n_
  Eigen::VectorXd n_, z_, y_, zz_, plus_, minus_, terms_, change_;
};

}  // namespace

std::vector<RankChange> rank_changes(const Scene& scene, const ConstVectorRef& at, const SceneData& data) {
  if (data.serial == 0) throw std::logic_error("rank_changes: there is no solution, call solve first");
  expect_configuration("rank_changes", "q", at, scene);
  std::vector<RankChange> out;
  std::vector<std::size_t> dependent, changing;
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
    const IslandReport& r = data.report.islands[i];
    if (r.status != Status::kFailed && r.rank < r.nc && r.rank < r.nv) dependent.push_back(i);
  }
  if (dependent.empty()) return out;
  const Eigen::VectorXd q = at;
  internal::AtRest rest(scene, data);
  std::vector<Probe> probes;
  for (int k = 0; k < kRankProbes; ++k) probes.emplace_back(scene, data, q, rest, k);
  for (const std::size_t i : dependent) {
    const auto any = [&](auto&& says) { return std::ranges::any_of(probes, says); };
    if (!any([i](const Probe& p) { return p.moves(i); })) continue;
    RankChange change{i, any([i](const Probe& p) { return p.singular(i); }), 0, 0, {}, -1};
    if (!change.singular && !any([i](const Probe& p) { return p.changes_beside(i); })) continue;
    change.rank = data.report.islands[i].rank;
    change.rows = data.report.islands[i].nc;
    change.contacts = probes[0].contacts(i);
    out.push_back(std::move(change));
    changing.push_back(i);
  }
  const std::vector<int> coordinates = probes[0].coordinates(changing);
  for (std::size_t k = 0; k < out.size(); ++k) out[k].coordinate = coordinates[k];
  return out;
}

}  // namespace manycontact
