#include "manycontact/simulation/resisting_joints.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/inertia_factor.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "resisting_forces.hpp"
#include "spring_share.hpp"

namespace manycontact::internal {

namespace {

bool rubs(const Robot& robot, const Eigen::VectorXd& friction) {
  return !friction.segment(robot.idx_v, robot.model->nv).isZero(0);
}

std::shared_ptr<Model> own_model(const Robot& robot, const Eigen::VectorXd& added) {
  auto model = std::make_shared<Model>(*robot.model);
  model->frames.clear();
  model->damping.resize(0), model->friction.resize(0);
  model->armature += added.segment(robot.idx_v, model->nv);
  return model;
}

// Returns the diagonal of M^-1 at q = 0 for joints with springs (infinite if M is singular), and 0 for other joints.
Eigen::VectorXd mobilities(const Scene& scene) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(scene.nv);
  int last = -1;
  std::vector<double> M, diagonal;
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[spring.robot];
    const Model& model = *robot.model;
    if (std::exchange(last, spring.robot) != spring.robot) {
      Kinematics<double> kin(model);
      std::vector<Inertia<double>> Yc(model.joints.size());
      forward_kinematics<double>(model, SE3<double>(), neutral(model), kin);
      M.resize(static_cast<std::size_t>(model.M_begin[model.nv]));
      diagonal.resize(static_cast<std::size_t>(model.nv));
      crba<double>(model, kin, Yc, M.data());
      if (!factorize_inertia(model, M.data(), diagonal.data()).empty()) diagonal.clear();
    }
    const int i = model.joints[spring.joint].idx_v;
    Eigen::VectorXd x = Eigen::VectorXd::Unit(model.nv, i);
    if (!diagonal.empty()) solve_inertia(model, M.data(), 1, x.data());
    out[robot.idx_v + i] = diagonal.empty() ? std::numeric_limits<double>::infinity() : x[i];
  }
  return out;
}

}  // namespace

// Returns the scene with inertias added. Equal robots share a model, unless friction changes their inertias.
Scene ResistingJoints::with_inertias(const Scene& scene) {
  added = to_add;
  Scene out = scene;
  std::vector<std::size_t> first;  // first robot of each set of equal robots
  models.assign(scene.robots.size(), nullptr);
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const Robot& robot = scene.robots[r];
    const auto mine = added.segment(robot.idx_v, robot.model->nv);
    if (rubs(robot, friction) || (vary && !mine.isZero(0))) {
      out.robots[r].model = models[r] = own_model(robot, added);
      continue;
    }
    if (mine.isZero(0)) continue;
    const auto same = std::ranges::find_if(first, [&](std::size_t other) {
      const Robot& twin = scene.robots[other];
      return twin.model == robot.model && added.segment(twin.idx_v, twin.model->nv) == mine;
    });
    if (same != first.end()) {
      out.robots[r].model = out.robots[*same].model;
      continue;
    }
    first.push_back(r);
    out.robots[r].model = own_model(robot, added);
  }
  return out;
}

ResistingJoints::ResistingJoints(const Scene& scene)
    : damping(Eigen::VectorXd::Zero(scene.nv)),
      friction(damping),
      slip(scene.nv, 0),
      mobility(mobilities(scene)),
      kept(damping),
      kept_k(damping) {
  for (const Robot& robot : scene.robots) {
    const Model& model = *robot.model;
    if (model.damping.size() > 0) damping.segment(robot.idx_v, model.nv) = model.damping;
    if (model.friction.size() > 0) friction.segment(robot.idx_v, model.nv) = model.friction;
  }
  for (int i = 0; i < scene.nv; ++i)
    if (friction[i] > 0) rubbing.push_back(i);
}

void add_stiffness(const Scene& scene, const PdLaws& pd, double scale, Eigen::VectorXd& k) {
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[spring.robot];
    k[robot.idx_v + robot.model->joints[spring.joint].idx_v] += scale * spring.stiffness;
  }
  if (pd.kp.size() > 0) k += scale * pd.kp;
}

void ResistingJoints::find(const Scene& scene, const PdLaws& pd, double h) {
  to_add = h * damping;
  kept_k.setZero();
  add_stiffness(scene, {}, h * h, kept_k);
  for (int i = 0; i < scene.nv; ++i) kept[i] = spring_share(kept_k[i] > 0 ? kept_k[i] * mobility[i] : 0);
  kept_k.array() *= kept.array();
  add_stiffness(scene, pd, h * h, to_add);
  if (pd.kd.size() > 0) to_add += h * pd.kd;
}

bool ResistingJoints::fits(const Scene& scene) const {
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const int at = scene.robots[r].idx_v, n = scene.robots[r].model->nv;
    if (!models[r] && added.segment(at, n) != to_add.segment(at, n)) return false;
  }
  return true;
}

void ResistingJoints::set_inertias(const Scene& scene, double h) {
  for (std::size_t r = 0; r < models.size(); ++r) {
    if (!models[r]) continue;
    const Robot& robot = scene.robots[r];
    for (int i = 0; i < robot.model->nv; ++i)
      models[r]->armature[i] = robot.model->armature[i] + inertia(robot.idx_v + i, h);
  }
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
    throw std::invalid_argument(
        "step: data.pd has vectors of a wrong size, expected four vectors of nv numbers, or four empty vectors");
  if (n == 0) return;
  if (!(pd.kp.minCoeff() >= 0 && pd.kd.minCoeff() >= 0))
    throw std::invalid_argument("step: a gain in data.pd is negative or not a number, expected gains of 0 or more");
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints)
      if (joint.nv() > 1 && !pd.kp.segment(robot.idx_v + joint.idx_v, joint.nv()).isZero(0))
        throw std::invalid_argument("step: joint " + robot.name + "/" + joint.name +
                                    " has several coordinates, expected kp = 0 for this joint in data.pd");
}

}  // namespace manycontact::internal
