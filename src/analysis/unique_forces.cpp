#include "manycontact/analysis/unique_forces.hpp"

#include <cmath>
#include <stdexcept>

#include "at_rest.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

namespace {

constexpr int kProbes = 2;         // that a component vanishes in both by accident is one case in 1e18
constexpr double kNothing = 1e-9;  // of the largest component of a projection: rounding

// w's projection on the null space of J^T. Twice, so that what rounding leaves of the first is gone.
Eigen::VectorXd null_part(internal::AtRest& rest, const Eigen::VectorXd& q, Eigen::VectorXd w) {
  Eigen::VectorXd x;
  for (int pass = 0; pass < 2; ++pass) {
    (void)rest.least_motion(q, w, x);
    w -= rest.velocities(q, x);
  }
  return w;
}

// Calls act(row) for an island's rows of f.
template <class Act>
void each_row(const Scene& scene, const SceneData& data, std::size_t island, Act&& act) {
  for (const int c : island_of(data, island).contacts)
    for (int k = 0; k < scene.contacts[c].rows(); ++k) act(data.f_offset[c] + k);
}

}  // namespace

std::vector<char> unique_forces(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, const SceneData& data) {
  if (data.serial == 0) throw std::logic_error("unique_forces: solve first");
  std::vector<char> unique(static_cast<std::size_t>(data.f.size()), 1);
  std::vector<std::size_t> dependent;
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
    const IslandReport& r = data.report.islands[i];
    if (r.status == Status::kFailed)
      each_row(scene, data, i, [&](int row) { unique[static_cast<std::size_t>(row)] = 0; });
    else if (r.rank < r.nc)
      dependent.push_back(i);
  }
  if (dependent.empty()) return unique;
  std::vector<char> active;  // those of the answer
  for (const int first : data.f_offset) active.push_back(first >= 0);
  internal::AtRest rest(scene, active, data.options);
  for (int probe = 0; probe < kProbes; ++probe) {
    Eigen::VectorXd w(data.f.size());
    for (Eigen::Index k = 0; k < w.size(); ++k) w[k] = std::cos(static_cast<double>(k * k + probe * (k + 1)));
    w = null_part(rest, q, w);
    for (const std::size_t i : dependent) {
      double largest = 0;
      each_row(scene, data, i, [&](int row) { largest = std::max(largest, std::abs(w[row])); });
      each_row(scene, data, i, [&](int row) {
        if (!(std::abs(w[row]) <= kNothing * largest)) unique[static_cast<std::size_t>(row)] = 0;
      });
    }
  }
  return unique;
}

}  // namespace manycontact
