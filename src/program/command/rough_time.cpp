#include "rough_time.hpp"

#include <algorithm>

namespace manycontact::cli {

namespace {

constexpr double kFlop = 9e-5;        // time per multiply-add of Eigen's products and LLT [us]
constexpr double kSlowFlop = 2.2e-4;  // time per multiply-add of a rank-revealing decomposition, by column [us]
constexpr double kCall = 5;           // time per island in addition [us]

double cube(double x) { return x * x * x; }

// Returns the predicted time [us] of a complete orthogonal decomposition of J^T and of products with its null space.
double dense(const Island& island) {
  const double n = island.nv, m = island.nc;
  return kCall + kSlowFlop * (4 * n * n * m + 2 * cube(n));
}

template <class Time>
double sum_over_islands(const SceneData& data, Time&& time) {
  double sum = 0;
  for (std::size_t i = 0; i < island_count(data); ++i) sum += time(solved_island(data, i));
  return sum;
}

}  // namespace

double median(std::vector<double> times) {
  std::ranges::sort(times);
  return 0.5 * (times[(times.size() - 1) / 2] + times[times.size() / 2]);
}

double rough_time_of_dense(const Scene& scene, const SceneData& data) {
  if (data.options.method != Method::kDenseSchur) return sum_over_islands(data, dense);
  double sum = 0;  // kDenseSchur treats the whole scene as one island
  for (const Island& island : find_islands(scene, data.active)) sum += dense(island);
  return sum;
}

double rough_time_of_solve(const Scene& scene, const SceneData& data) {
  if (data.options.method == Method::kDense) return rough_time_of_dense(scene, data);
  if (data.options.method != Method::kDenseSchur) return 0;
  const double n = scene.nv, m = static_cast<double>(data.f.size());
  return kFlop * (cube(n) / 3 + n * n * m + n * m * m + cube(m) / 3);  // LLT of M, Z = L^-1 J^T, Z^T Z, LLT of Z^T Z
}

double rough_time_of_derivatives(const Scene& scene, const SceneData& data) {
  if (data.options.method == Method::kDense)
    return sum_over_islands(data, [](const Island& island) { return 20 * kFlop * cube(island.size()); });
  if (data.options.method != Method::kDenseSchur) return 0;
  const double n = scene.nv + static_cast<double>(data.f.size());
  return kFlop * (2 * cube(n) + 2 * n * n * (2 * scene.nv + scene.nu));  // K^-1; product with all right-hand sides
}

}  // namespace manycontact::cli
