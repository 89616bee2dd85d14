#include "manycontact/analysis/near_dependent.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>

#include "at_rest.hpp"
#include "manycontact/analysis/ranks.hpp"
#include "manycontact/analysis/text.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact {

namespace {

constexpr double kMostUnasked = 1e9;  // largest nv nc^2 of an island whose rows are examined
constexpr double kEps = std::numeric_limits<double>::epsilon();

// Returns whether an island's rows are examined: the island must be undamped, solved, and not too large.
bool judged(const Scene& scene, const IslandReport& r) {
  const double work = static_cast<double>(r.nv) * r.nc * r.nc;
  return scene.damping == 0 && r.status != Status::kFailed && r.nc > 0 && work <= kMostUnasked;
}
// Returns an island's gap between the smallest remainder (ranks.hpp) of its independent rows and the largest one of its
// dependent rows.
RankGap gap_of(const Scene& scene, const SceneData& data, std::size_t island) {
  RankGap out;
  out.most_dropped = kEps;
  if (!judged(scene, data.report.islands[island])) return out;
  const auto [left, dependent] = internal::row_remainders(scene, data, island);
  const std::vector<int> rows = internal::rows_of(scene, data, island);
  out.known = !left.empty();
  for (std::size_t k = 0; k < left.size(); ++k) {
    const bool kept = left[k] > dependent;
    if (kept && (out.kept < 0 || left[k] < out.least_kept)) out.least_kept = left[k], out.kept = rows[k];
    if (!kept && (out.dropped < 0 || left[k] > out.most_dropped)) {
      out.most_dropped = std::max(kEps, left[k]);
      out.dropped = rows[k];
    }
  }
  return out;
}

// Changes a solution a, f to the solution without the constraint rows `rows`. It adds the responses to accelerations of
// these rows, which are chosen such that the forces of these rows become zero.
void leave_out(const std::vector<int>& rows, const Eigen::VectorXd& q, internal::AtRest& rest, Eigen::VectorXd& a,
               Eigen::VectorXd& f) {
  const auto m = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd X(a.size(), m), F(f.size(), m);  // responses of a and f to a unit acceleration of each row
  Eigen::VectorXd x;
  for (Eigen::Index k = 0; k < m; ++k) {
    (void)rest.least_motion(q, Eigen::VectorXd::Unit(f.size(), rows[k]), x);
    X.col(k) = x;
    F.col(k) = rest.forces();
  }
  const Eigen::VectorXd w =
      Eigen::MatrixXd(F(rows, Eigen::all)).completeOrthogonalDecomposition().solve(-Eigen::VectorXd(f(rows)));
  a += X * w;
  f += F * w;
}

}  // namespace

RankGap rank_gap(const Scene& scene, const SceneData& data, std::size_t island) {
  if (data.serial == 0) throw std::logic_error("rank_gap: there is no solution, call solve first");
  return gap_of(scene, data, island);
}

std::vector<RankGap> rank_gaps(const Scene& scene, const SceneData& data) {
  if (data.serial == 0) throw std::logic_error("rank_gaps: there is no solution, call solve first");
  std::vector<RankGap> out;
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) out.push_back(gap_of(scene, data, i));
  return out;
}

std::vector<NearDependent> near_dependent(const Scene& scene, const ConstVectorRef& at, const SceneData& data) {
  if (data.serial == 0) throw std::logic_error("near_dependent: there is no solution, call solve first");
  expect_configuration("near_dependent", "q", at, scene);
  std::vector<NearDependent> out;
  std::optional<internal::AtRest> rest;
  const Eigen::VectorXd q = at;
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
    if (!judged(scene, data.report.islands[i])) continue;
    const auto [left, dependent] = internal::row_remainders(scene, data, i);
    const std::vector<int> rows = internal::rows_of(scene, data, i);
    NearDependent found;
    found.island = i;
    found.left = kOnlyJust;
    for (std::size_t k = 0; k < left.size(); ++k) {
      if (!(left[k] > dependent && left[k] < kOnlyJust)) continue;
      found.rows.push_back(rows[k]);
      found.left = std::min(found.left, left[k]);
    }
    if (found.rows.empty()) continue;
    if (!rest) rest.emplace(scene, internal::active_of(data), data.options);
    Eigen::VectorXd a = data.a, f = data.f;
    leave_out(found.rows, q, *rest, a, f);
    double forces = 0, loads = 0;
    for (const int row : rows) {
      forces = std::max(forces, std::abs(data.f[row]));
      loads = std::max(loads, std::abs(f[row]));
    }
    internal::each_coordinate(scene, data, i, [&](int k) {
      loads = std::max(loads, std::abs(data.tau[k]));
      const double change = std::abs(a[k] - data.a[k]);
      if (found.coordinate >= 0 && !(change > std::abs(found.without - found.acceleration))) return;
      found.coordinate = k, found.acceleration = data.a[k], found.without = a[k];
    });
    found.times = loads > 0 ? forces / loads : std::numeric_limits<double>::infinity();
    out.push_back(std::move(found));
  }
  return out;
}

std::string in_words(const Scene& scene, const NearDependent& n) {
  char left[32];
  std::snprintf(left, sizeof left, "%.1e", n.left);
  std::string text = std::string("only ") + left + " of " + (n.rows.size() == 1 ? "the row" : "the smallest row") +
                     " is independent of the other rows";
  if (std::isfinite(n.times) && n.times > 1) text += ", and forces are " + text::number(n.times) + " times the loads";
  const double rounding = 1e-9 * std::abs(n.without);
  text += std::string("; without the row") + (n.rows.size() == 1 ? "" : "s") + ", " +
          velocity_names(scene)[n.coordinate] + " would accelerate by " + text::number(n.without) + " instead of " +
          text::number(std::abs(n.acceleration) > rounding ? n.acceleration : 0);
  return text +
         ". Rounded numbers in a file cause such rows: `inspect` recommends other contacts, and tolerance=\"...\" in "
         "the scene sets the accuracy of the numbers";
}

}  // namespace manycontact
