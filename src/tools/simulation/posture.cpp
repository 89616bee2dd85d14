#include "manycontact/simulation/posture.hpp"

#include <algorithm>
#include <cmath>

#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

namespace {

constexpr int kFirstIterations = 6;  // inverse iterations from an arbitrary start vector

// Returns x^T y over the rows of an island.
double product(const Scene& scene, const SceneData& data, const Island& island, const Eigen::VectorXd& x,
               const Eigen::VectorXd& y) {
  double sum = 0;
  each_force_block(scene, data.f_offset, island,
                   [&](int at, int, int n) { sum += x.segment(at, n).dot(y.segment(at, n)); });
  return sum;
}

// Makes one inverse iteration at q, which solves for a and f with the right-hand side w. Returns false if it failed.
bool iterate(const Eigen::VectorXd& q, PostureData& d) {
  return solve_tau(d.rest.scene, q, d.rest.zero, d.rest.zero, d.w, d.dynamics).status != Status::kFailed;
}

// Sets the island's rows of w to f / |f|. Returns |f|, or 0 if f is zero or not finite.
double take_rows(const Scene& scene, const Island& island, PostureData& d) {
  const Eigen::VectorXd& f = d.dynamics.f;
  const double size = std::sqrt(product(scene, d.dynamics, island, f, f));
  if (!(size > 0 && std::isfinite(size))) return 0;
  each_force_block(scene, d.dynamics.f_offset, island,
                   [&](int at, int, int n) { d.w.segment(at, n) = f.segment(at, n) / size; });
  return size;
}

// Sets w to a unit vector in every island, with different entries, so that symmetries of the scene cancel no terms.
void begin(const Scene& scene, const std::vector<char>& active, PostureData& d) {
  d.active = active;
  d.dynamics.active = active;
  prepare(d.rest.scene, d.dynamics);
  d.w.resize(d.dynamics.f.size());
  for (Eigen::Index k = 0; k < d.w.size(); ++k) d.w[k] = std::cos(static_cast<double>(k * k));
  for (std::size_t i = 0; i < island_count(d.dynamics); ++i) {
    const Island& island = solved_island(d.dynamics, i);
    const double size = std::sqrt(product(scene, d.dynamics, island, d.w, d.w));
    each_force_block(scene, d.dynamics.f_offset, island, [&](int at, int, int n) { d.w.segment(at, n) /= size; });
  }
  d.sigma.assign(island_count(d.dynamics), 0);
  d.largest = d.sigma;
  d.known = false;
}

// Returns the minimum of |(1 - s) x0 + s x1| over s in [0, 1], and its s, from |x0|, |x1| and x0^T x1.
ClosestPosture closest_between(double size0, double size1, double product01) {
  const double step2 = size0 * size0 + size1 * size1 - 2 * product01;
  const double at = step2 > 0 ? std::clamp((size0 * size0 - product01) / step2, 0.0, 1.0) : 1;
  const double least2 = (1 - at) * (1 - at) * size0 * size0 + at * at * size1 * size1 + 2 * at * (1 - at) * product01;
  return {std::sqrt(std::max(least2, 0.0)), at};
}

// Updates w+, x and sigma of an island. Returns the least sigma between the last and the current state.
ClosestPosture advance(const Scene& scene, std::size_t i, PostureData& d) {
  const Island& island = solved_island(d.dynamics, i);
  const double size = take_rows(scene, island, d);
  if (size == 0) return {};
  double sigma2 = 0;  // w+^T J x = w+^T w / |f|
  each_force_block(scene, d.dynamics.f_offset, island,
                   [&](int at, int, int n) { sigma2 += d.w.segment(at, n).dot(d.asked.segment(at, n)) / size; });
  const double sigma = std::sqrt(std::max(sigma2, 0.0));
  ClosestPosture out;
  if (d.known) out = closest_between(d.sigma[i], sigma, product(scene, d.dynamics, island, d.Jx, d.w));
  d.sigma[i] = sigma;
  d.largest[i] = std::max(d.largest[i], sigma);
  out.share = d.known && d.largest[i] > 0 ? out.share / d.largest[i] : 1;
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    d.x.segment(robot.idx_v, robot.model->nv) = d.dynamics.a.segment(robot.idx_v, robot.model->nv) / size;
  }
  return out;
}

}  // namespace

PostureData::PostureData(const Scene& scene, const Options& options)
    : rest(scene), dynamics(rest.scene, options), x(Eigen::VectorXd::Zero(scene.nv)), scratch(x) {}

ClosestPosture follow_posture(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q,
                              PostureData& d) {
  d.rest.follow(scene, 0);
  d.rest.scene.damping = 0;
  const bool anew = d.active != active;
  if (anew) begin(scene, active, d);
  if (d.w.size() == 0) return {};
  for (int k = anew ? kFirstIterations : 1; k > 0; --k) {
    d.asked = d.w;
    if (!iterate(q, d)) {
      d.active.clear();  // makes the next call restart the inverse iteration
      return {};
    }
    for (std::size_t i = 0; k > 1 && i < island_count(d.dynamics); ++i)
      (void)take_rows(scene, solved_island(d.dynamics, i), d);
  }
  // J x with the last state's x is needed for x_k^T M x_k+1 = w_k+1^T J x_k
  d.Jx.resize(d.w.size());
  d.rest.inverse_dynamics_of(d.rest.scene, q, d.x, d.rest.zero, Vec3<double>::Zero(), d.scratch);
  d.rest.contact_velocities(d.dynamics.f_offset, d.Jx);
  ClosestPosture out;
  for (std::size_t i = 0; i < island_count(d.dynamics); ++i)
    if (const ClosestPosture of_island = advance(scene, i, d); of_island.share < out.share) out = of_island;
  d.known = true;
  return out;
}

}  // namespace manycontact
