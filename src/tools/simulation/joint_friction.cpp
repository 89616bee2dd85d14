// Newton's method of resisting_joints.hpp, which finds the joints that stick and the joints that slide.

#include <algorithm>
#include <numeric>
#include <span>

#include "manycontact/dynamics/views.hpp"
#include "manycontact/simulation/resisting_joints.hpp"

namespace manycontact::internal {

namespace {

constexpr int kBisections = 60;

// Finds the islands of joints with friction, and sorts these joints by island. With springs, all islands count as one.
void find_islands(const Scene& scene, const SceneData& islands, ResistingJoints& j) {
  j.island.assign(j.rubbing.size(), 0);
  std::size_t r = 0;
  for (std::size_t k = 0; scene.springs.empty() && k < j.rubbing.size(); ++k) {
    while (j.rubbing[k] >= scene.robots[r].idx_v + scene.robots[r].model->nv) ++r;
    j.island[k] = island_with_robot(islands, static_cast<int>(r));
  }
  j.order.resize(j.rubbing.size());
  std::iota(j.order.begin(), j.order.end(), 0);
  std::ranges::sort(j.order, {}, [&](int k) { return std::pair(j.island[k], k); });
}

double huber_slope(double v) { return std::clamp(v / kStickVelocity, -1.0, 1.0); }

signed char slip_at(double v) {
  return static_cast<signed char>(v >= kStickVelocity ? 1 : v <= -kStickVelocity ? -1 : 0);
}

// Returns the slope of the function that resisting_joints.hpp minimises, along v_next - v at the point
// v + s (v_next - v). It is the sum over `joints`.
double slope_at(double s, std::span<const int> joints, double h, const ResistingJoints& j) {
  double out = 0;
  for (const int k : joints) {
    const double way = j.next_speed[k] - j.speed[k];
    const double force = j.force[k] + s * (j.next_force[k] - j.force[k]);
    out += way * (force + h * j.friction[j.rubbing[k]] * huber_slope(j.speed[k] + s * way));
  }
  return out;
}

double line_search(std::span<const int> joints, double h, const ResistingJoints& j) {
  if (slope_at(1, joints, h, j) <= 0) return 1;
  double low = 0, high = 1;
  for (int k = 0; k < kBisections; ++k) {
    const double middle = (low + high) / 2;
    (slope_at(middle, joints, h, j) <= 0 ? low : high) = middle;
  }
  return high;
}

void advance(double h, ResistingJoints& j) {
  for (std::size_t first = 0, end = 0; first < j.order.size(); first = end) {
    while (end < j.order.size() && j.island[j.order[end]] == j.island[j.order[first]]) ++end;
    const std::span<const int> joints(j.order.data() + first, end - first);
    const double s = line_search(joints, h, j);
    for (const int k : joints) {
      j.speed[k] += s * (j.next_speed[k] - j.speed[k]);
      j.force[k] += s * (j.next_force[k] - j.force[k]);
    }
  }
}

}  // namespace

bool ResistingJoints::settles(const Scene& scene, const SceneData& islands, double h, const Eigen::VectorXd& v_next) {
  const auto n = static_cast<Eigen::Index>(rubbing.size());
  next_speed.resize(n), next_force.resize(n);
  bool settled = true;
  for (Eigen::Index k = 0; k < n; ++k) {
    const int i = rubbing[k];
    next_speed[k] = v_next[i];
    next_force[k] = -h * friction[i] * (slip[i] != 0 ? slip[i] : v_next[i] / kStickVelocity);
    settled = settled && slip_at(v_next[i]) == slip[i];
  }
  if (settled) return true;
  if (!begun) {
    begun = true;
    find_islands(scene, islands, *this);
    speed = next_speed, force = next_force;
  } else {
    advance(h, *this);
  }
  for (Eigen::Index k = 0; k < n; ++k) slip[rubbing[k]] = slip_at(speed[k]);
  return false;
}

}  // namespace manycontact::internal
