#include <algorithm>
#include <cmath>

#include "internal.hpp"
#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/simulation/resisting_joints.hpp"
#include "manycontact/spatial/motion.hpp"

namespace manycontact::internal {

namespace {

// Returns the Lie bracket [w, v] of SE(2) in coordinates (x, y, angle).
Vec3<double> bracket_se2(const Vec3<double>& w, const Vec3<double>& v) {
  return {w[1] * v[2] - w[2] * v[1], w[2] * v[0] - w[0] * v[2], 0};
}

template <class Vector, class Bracket>
Vector series(const Vector& w, const Vector& v, Bracket&& bracket) {
  const Vector once = bracket(w, v), twice = bracket(w, once);
  return v + once / 2 + twice / 12;
}

// Computes out = v + [w, v]/2 + [w, [w, v]]/12 for every joint, where [ , ] is the Lie bracket. w, v, out: nv.
void dexp_inverse(const Scene& scene, const Eigen::VectorXd& w, const Eigen::VectorXd& v, Eigen::VectorXd& out) {
  out = v;  // this is exact for joints with one coordinate
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints) {
      const int i = robot.idx_v + joint.idx_v;
      if (joint.type == JointType::kFloating) {
        out.segment<6>(i) = series<Vec6<double>>(
            w.segment<6>(i), v.segment<6>(i),
            [](const Vec6<double>& x, const Vec6<double>& y) { return Vec6<double>(cross_motion(x, y)); });
      } else if (joint.type == JointType::kPlanar) {
        out.segment<3>(i) = series<Vec3<double>>(w.segment<3>(i), v.segment<3>(i), bracket_se2);
      }
    }
}

// Adds work and mean torques of resisting forces at an RK4 stage. weight: the stage's weight in the step.
void account_for_stage(const Scene& scene, double weight, SimulationData& d) {
  const double dt = weight * d.h;
  for (const Robot& robot : scene.robots) {
    const Model& model = *robot.model;
    for (Eigen::Index i = 0; i < model.damping.size(); ++i)
      d.work.dampers -= dt * model.damping[i] * d.stage_v[robot.idx_v + i] * d.stage_v[robot.idx_v + i];
    for (Eigen::Index i = 0; i < model.friction.size(); ++i) {
      const double v = d.stage_v[robot.idx_v + i];
      d.work.friction -= dt * model.friction[i] * std::tanh(v / kFrictionVelocity) * v;
    }
  }
  if (std::ranges::any_of(scene.springs, [](const Spring& s) { return s.damping > 0; })) {
    find_applied_wrenches<double>(scene, d.stage_q.data(), d.stage_v.data(), d.dynamics.wrenches, *d.applied);
    d.work.dampers += dt * power_of(scene, *d.applied).dampers;
  }
  if (d.pd.kp.size() == 0) return;
  d.tau.setZero();
  add_pd_torques(scene, d.pd, d.stage_q, d.stage_v, d.tau);
  d.pd_torque += weight * d.tau;
  d.work.pd += dt * d.tau.dot(d.stage_v);
}

}  // namespace

bool step_rk4(const Scene& scene, const ConstVector& u, SimulationData& d) {
  constexpr double node[] = {0, 0.5, 0.5, 1}, weight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  d.work = {};
  if (d.pd.kp.size() > 0) d.pd_torque.setZero(scene.nv);
  d.w_sum.setZero();
  d.v_sum.setZero();
  for (int s = 0; s < 4; ++s) {
    if (s == 0) {
      d.w.setZero();
      d.stage_v = d.v;
      d.stage_q = d.q;
    } else {
      d.w = node[s] * d.h * d.w_rate;
      d.stage_v = d.v + node[s] * d.h * d.v_rate;
      integrate_scene(scene, d.q, d.w, d.stage_q);
    }
    if (!solve_stage(scene, d.stage_q, d.stage_v, u, d)) return false;
    if (s == 0) {
      keep_what_depends(d.dynamics, d);
      keep_forces(d);
      watch_condition(scene, d.dynamics, d);
    }
    account_for_stage(scene, weight[s], d);
    dexp_inverse(scene, d.w, d.stage_v, d.w_rate);
    d.v_rate = d.dynamics.a;
    d.w_sum += weight[s] * d.h * d.w_rate;
    d.v_sum += weight[s] * d.h * d.v_rate;
  }
  integrate_scene(scene, d.q, d.w_sum, d.next_q);
  d.next_v = d.v + d.v_sum;
  return true;
}

}  // namespace manycontact::internal
