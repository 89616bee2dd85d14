#include <algorithm>
#include <cmath>

#include "manycontact/analysis/findings.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact {

std::string to_string(LimitKind quantity) {
  constexpr const char* kNames[] = {"position", "velocity", "effort"};
  return kNames[static_cast<int>(quantity)];
}

namespace {

// Returns whether x exceeds `limit` by more than a rounding error: 1e-9 times the larger of |limit| and a finite range.
bool beyond(double x, double limit, double range) {
  return x > limit + 1e-9 * std::max(std::abs(limit), std::isfinite(range) ? range : 0);
}

void look_at(const Joint& joint, int k, LimitKind quantity, double x, LimitPassed found,
             std::vector<LimitPassed>& out) {
  found.quantity = quantity;
  found.value = x;
  if (quantity == LimitKind::kPosition) {
    if (joint.lower.size() != joint.nv() || joint.upper.size() != joint.nv() || !(joint.lower[k] <= joint.upper[k]))
      return;
    found.limit =
        x > 0.5 * (joint.lower[k] + joint.upper[k]) || !std::isfinite(joint.lower[k]) ? joint.upper[k] : joint.lower[k];
    const double range = joint.upper[k] - joint.lower[k];
    if (beyond(x, joint.upper[k], range) || beyond(-x, -joint.lower[k], range)) out.push_back(found);
    return;
  }
  const Eigen::VectorXd& limits = quantity == LimitKind::kVelocity ? joint.velocity_limit : joint.effort_limit;
  if (limits.size() != joint.nv() || !(limits[k] > 0) || !beyond(std::abs(x), limits[k], 0)) return;
  found.limit = limits[k];
  out.push_back(found);
}

}  // namespace

std::vector<LimitPassed> limits_passed(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                       const ConstVectorRef& u) {
  expect_configuration("limits_passed", "q", q, scene);
  expect_numbers("limits_passed", "v", v, scene.nv);
  expect_numbers("limits_passed", "u", u, scene.nu);
  std::vector<LimitPassed> out;
  for (int r = 0; r < scene.nrobots(); ++r) {
    const Robot& robot = scene.robots[r];
    for (const Joint& joint : robot.model->joints) {
      const int torque = robot.model->torque_index(joint);
      for (int k = 0; k < joint.nv() && joint.type != JointType::kFloating; ++k) {
        const LimitPassed at{r, joint.idx_v + k, LimitKind::kPosition, 0, 0};
        look_at(joint, k, LimitKind::kPosition, q[robot.idx_q + joint.idx_q + k], at, out);
        look_at(joint, k, LimitKind::kVelocity, v[robot.idx_v + joint.idx_v + k], at, out);
        if (torque >= 0) look_at(joint, k, LimitKind::kEffort, u[robot.idx_u + torque + k], at, out);
      }
    }
  }
  return out;
}

}  // namespace manycontact
