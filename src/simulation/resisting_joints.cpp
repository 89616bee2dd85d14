#include "resisting_joints.hpp"

#include <algorithm>
#include <stdexcept>

#include "internal.hpp"
#include "resisting_forces.hpp"

namespace manycontact::internal {

namespace {

// use(robot, coordinate of the scene, of the robot)
template <class Use>
void each_coordinate(const Scene& scene, Use&& use) {
  for (std::size_t r = 0; r < scene.robots.size(); ++r)
    for (int i = 0; i < scene.robots[r].model->nv; ++i) use(r, scene.robots[r].idx_v + i, i);
}

bool rubs(const Robot& robot, const Eigen::VectorXd& friction) {
  return !friction.segment(robot.idx_v, robot.model->nv).isZero(0);
}

std::shared_ptr<Model> own_model(const Robot& robot, const Eigen::VectorXd& added) {
  auto model = std::make_shared<Model>(*robot.model);
  model->frames.clear();
  model->armature += added.segment(robot.idx_v, model->nv);
  return model;
}

// The scene with `added` in its armatures. Robots alike share a model, unless friction or a PD law changes theirs.
Scene with_inertias(const Scene& scene, ResistingJoints& j) {
  Scene out = scene;
  std::vector<std::size_t> first;  // of robots alike
  j.models.assign(scene.robots.size(), nullptr);
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const Robot& robot = scene.robots[r];
    const auto mine = j.added.segment(robot.idx_v, robot.model->nv);
    if (rubs(robot, j.friction) || (j.vary && !mine.isZero(0))) {
      out.robots[r].model = j.models[r] = own_model(robot, j.added);
      continue;
    }
    if (mine.isZero(0)) continue;
    const auto same = std::find_if(first.begin(), first.end(), [&](std::size_t other) {
      const Robot& twin = scene.robots[other];
      return twin.model == robot.model && j.added.segment(twin.idx_v, twin.model->nv) == mine;
    });
    if (same != first.end()) {
      out.robots[r].model = out.robots[*same].model;
      continue;
    }
    first.push_back(r);
    out.robots[r].model = own_model(robot, j.added);
  }
  return out;
}

// Anew where the inertias of robots that share a model change.
void make_scene(const Scene& scene, SimulationData& d, ResistingJoints& j) {
  j.vary = j.made;
  j.made = true;
  j.added = j.to_add;
  d.kept_active.clear();
  j.at_rest.reset(), j.dynamics.reset();
  if (j.added.isZero(0) && j.rubbing.empty()) return;
  j.at_rest = std::make_unique<SceneAtRest>(with_inertias(scene, j));
  j.dynamics = std::make_unique<SceneData>(j.at_rest->scene, d.dynamics.options);
}

bool all_vary(const Scene& scene, const ResistingJoints& j) {
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const int at = scene.robots[r].idx_v, n = scene.robots[r].model->nv;
    if (j.models[r] == nullptr && j.added.segment(at, n) != j.to_add.segment(at, n)) return false;
  }
  return true;
}

}  // namespace

ResistingJoints::ResistingJoints(const Scene& scene)
    : damping(Eigen::VectorXd::Zero(scene.nv)), friction(damping), slip(scene.nv, 0) {
  for (const Robot& robot : scene.robots) {
    const Model& model = *robot.model;
    if (model.damping.size() > 0) damping.segment(robot.idx_v, model.nv) = model.damping;
    if (model.friction.size() > 0) friction.segment(robot.idx_v, model.nv) = model.friction;
    for (const Joint& joint : model.joints)
      for (int i = 0; i < joint.nv(); ++i) place.push_back(joint.nv() == 1 ? robot.idx_q + joint.idx_q : -1);
  }
  for (int i = 0; i < scene.nv; ++i)
    if (friction[i] > 0) rubbing.push_back(i);
}

AtRest at_rest_with_joints(const Scene& scene, SimulationData& d) {
  if (!d.resisting || !d.resisting->joints.dynamics) return {d.at_rest.scene, d.dynamics};
  ResistingJoints& j = d.resisting->joints;
  j.at_rest->follow(scene, d.h);
  j.dynamics->options = d.dynamics.options;
  j.dynamics->active = d.dynamics.active;
  return {j.at_rest->scene, *j.dynamics};
}

void take_joints(const Scene& scene, SimulationData& d) {
  ResistingJoints& j = d.resisting->joints;
  const double h = d.h;
  j.to_add = h * j.damping;
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    j.to_add[robot.idx_v + robot.model->joints[spring.joint].idx_v] += h * h * spring.stiffness;
  }
  if (d.pd.kp.size() > 0) {
    j.to_add += h * d.pd.kd + h * h * d.pd.kp;
    add_pd_torques(scene, d.pd, d.q, d.at_rest.zero, d.w);
  }
  if (!j.made || (j.to_add != j.added && !all_vary(scene, j))) make_scene(scene, d, j);
  j.added = j.to_add;
  j.begun = false;
}

void begin_friction(const Scene& scene, SimulationData& d, Eigen::VectorXd& b) {
  ResistingJoints& j = d.resisting->joints;
  for (std::size_t r = 0; r < j.models.size(); ++r)
    if (j.models[r])
      j.models[r]->armature = scene.robots[r].model->armature + j.added.segment(scene.robots[r].idx_v, j.models[r]->nv);
  for (const int i : j.rubbing) b[i] -= j.slip[i] * d.h * j.friction[i];
  each_coordinate(scene, [&](std::size_t r, int i, int own) {
    if (j.friction[i] > 0 && j.slip[i] == 0) j.models[r]->armature[own] += d.h * j.friction[i] / kStickVelocity;
  });
}

void account_for_joints(const Scene& scene, SimulationData& d, const Eigen::VectorXd& v_next) {
  ResistingJoints& j = d.resisting->joints;
  const double h = d.h;
  d.stage_v = 0.5 * h * (d.v + v_next);  // torques times this are work
  d.work.dampers -= (j.damping.array() * v_next.array() * d.stage_v.array()).sum();
  for (const int i : j.rubbing) {
    const double torque = -j.friction[i] * (j.slip[i] != 0 ? j.slip[i] : v_next[i] / kStickVelocity);
    d.work.friction += torque * d.stage_v[i];
  }
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    const Joint& joint = robot.model->joints[spring.joint];
    const int i = robot.idx_v + joint.idx_v;
    const double e = d.q[robot.idx_q + joint.idx_q] - spring.rest, moved = h * v_next[i];
    d.work.springs += spring.stiffness * (moved * (e + moved / 2) - (e + moved) * d.stage_v[i]);
  }
  if (d.pd.kp.size() == 0) return;
  d.pd_torque.setZero(scene.nv);
  add_pd_torques(scene, d.pd, d.q, v_next, d.pd_torque);
  d.pd_torque -= h * d.pd.kp.cwiseProduct(v_next);
  d.work.pd += d.pd_torque.dot(d.stage_v);
}

void add_pd_torques(const Scene& scene, const PdLaws& pd, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                    Eigen::VectorXd& tau) {
  tau += pd.kd.cwiseProduct(pd.v_ref - v);
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints)
      if (const int i = robot.idx_v + joint.idx_v; joint.nv() == 1 && pd.kp[i] != 0)
        tau[i] += pd.kp[i] * (pd.q_ref[i] - q[robot.idx_q + joint.idx_q]);
}

void check_pd(const Scene& scene, const PdLaws& pd) {
  const Eigen::Index n = pd.kp.size();
  if (pd.kd.size() != n || pd.q_ref.size() != n || pd.v_ref.size() != n || (n != 0 && n != scene.nv))
    throw std::invalid_argument("step: data.pd does not fit the scene, expected four vectors of nv numbers or of none");
  if (n == 0) return;
  if (!(pd.kp.minCoeff() >= 0 && pd.kd.minCoeff() >= 0))
    throw std::invalid_argument("step: a gain in data.pd is negative or no number");
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints)
      if (joint.nv() > 1 && !pd.kp.segment(robot.idx_v + joint.idx_v, joint.nv()).isZero(0))
        throw std::invalid_argument("step: joint " + robot.name + "/" + joint.name +
                                    " has several coordinates, expected no kp of it in data.pd");
}

}  // namespace manycontact::internal
