#include "resisting_forces.hpp"

namespace manycontact::internal {

namespace {

void make_scene(const Scene& scene, SimulationData& d) {
  ResistingForces& r = *d.resisting;
  r.joints.vary = r.made;  // inertias that change a second time may change in every step
  r.made = true;
  d.kept_active.clear();
  r.at_rest.reset(), r.dynamics.reset();
  const Scene with = r.joints.with_inertias(scene);
  if (r.joints.added.isZero(0) && r.joints.rubbing.empty()) return;
  r.at_rest = std::make_unique<SceneAtRest>(with);
  r.dynamics = std::make_unique<SceneData>(r.at_rest->scene, d.dynamics.options);
}

}  // namespace

AtRest at_rest_with_joints(SimulationData& d) {
  if (!d.resisting || !d.resisting->dynamics) return {d.at_rest.scene, d.dynamics};
  return {d.resisting->at_rest->scene, *d.resisting->dynamics};
}

void take_joints(const Scene& scene, SimulationData& d) {
  ResistingJoints& j = d.resisting->joints;
  j.find(scene, d.pd, d.h);
  if (d.pd.kp.size() > 0) add_pd_torques(scene, d.pd, d.q, d.at_rest.zero, d.w);
  d.w += j.kept_k.cwiseProduct(d.v) / d.h;
  if (!d.resisting->made || !j.fits(scene)) make_scene(scene, d);
  j.added = j.to_add;
  j.begun = false;
  if (!d.resisting->dynamics) return;
  d.resisting->at_rest->follow(scene, d.h);
  d.resisting->dynamics->options = d.dynamics.options;
  d.resisting->dynamics->active = d.dynamics.active;
}

void account_for_joints(const Scene& scene, SimulationData& d, const Eigen::VectorXd& v_next) {
  ResistingJoints& j = d.resisting->joints;
  const double h = d.h;
  d.stage_v = 0.5 * h * (d.v + v_next);  // work is torque times stage_v
  d.work.dampers -= (j.damping.array() * v_next.array() * d.stage_v.array()).sum();
  for (const int i : j.rubbing) {
    const double torque = -j.friction[i] * (j.slip[i] != 0 ? j.slip[i] : v_next[i] / kStickVelocity);
    d.work.friction += torque * d.stage_v[i];
  }
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[spring.robot];
    const Joint& joint = robot.model->joints[spring.joint];
    const int i = robot.idx_v + joint.idx_v;
    const double e = d.q[robot.idx_q + joint.idx_q] - spring.rest, moved = h * v_next[i];
    const double strained = e + moved - j.kept[i] * h * d.v[i];  // strain that sets the force
    d.work.springs += (1 - j.kept[i]) * spring.stiffness * (moved * (e + moved / 2) - strained * d.stage_v[i]);
  }
  if (d.pd.kp.size() == 0) return;
  d.pd_torque.setZero(scene.nv);
  add_pd_torques(scene, d.pd, d.q, v_next, d.pd_torque);
  d.pd_torque -= h * d.pd.kp.cwiseProduct(v_next);
  d.work.pd += d.pd_torque.dot(d.stage_v);
}

}  // namespace manycontact::internal
