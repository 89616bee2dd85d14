#include "manycontact/analysis/unique_forces.hpp"

#include <cmath>
#include <stdexcept>

#include "at_rest.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact {

namespace {

constexpr int kNullProbes = 2;    // random projections on the null space of J^T, so that no nonzero component is missed
constexpr double kNoPart = 1e-9;  // smaller components, relative to the projection's largest, are zero

}  // namespace

std::vector<char> unique_forces(const Scene& scene, const ConstVectorRef& q, const SceneData& data) {
  if (data.serial == 0) throw std::logic_error("unique_forces: there is no solution, call solve first");
  expect_configuration("unique_forces", "q", q, scene);
  std::vector<char> unique(static_cast<std::size_t>(data.f.size()), 1);
  std::vector<std::size_t> dependent;
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
    const IslandReport& r = data.report.islands[i];
    if (r.status == Status::kFailed)
      internal::each_row(scene, data, i, [&](int row) { unique[row] = 0; });
    else if (r.rank < r.nc)
      dependent.push_back(i);
  }
  if (dependent.empty()) return unique;
  internal::AtRest rest(scene, data);
  const Eigen::VectorXd change = rest.change_of_null(q, inaccuracy_of(scene, data));
  for (int probe = 0; probe < kNullProbes; ++probe) {
    const Eigen::VectorXd w = rest.null_component(q, internal::mixed(data.f.size(), probe));
    for (const std::size_t i : dependent) {
      double largest = 0;
      internal::each_row(scene, data, i, [&](int row) { largest = std::max(largest, std::abs(w[row])); });
      const double least = kNoPart * largest + internal::change_in(scene, data, i, w, change);
      internal::each_row(scene, data, i, [&](int row) {
        if (!(std::abs(w[row]) <= least)) unique[row] = 0;
      });
    }
  }
  return unique;
}

}  // namespace manycontact
