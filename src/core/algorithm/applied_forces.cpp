#include "manycontact/algorithm/applied_forces.hpp"

#include <algorithm>

#include "spring_end.hpp"

namespace manycontact {

namespace {

template <class S>
typename AppliedForces<S>::OfRobot& of_robot(const Scene& scene, int robot, AppliedForces<S>& forces) {
  int& number = forces.number[robot];
  if (number < 0) {
    const Model& model = *scene.robots[robot].model;
    number = static_cast<int>(forces.robots.size());
    forces.robots.push_back({robot, {}, {}, {}, {}, Kinematics<S>(model), {}});
    forces.robots.back().f.resize(model.njoints());
  }
  return forces.robots[number];
}

// Adds the joint of an attachment and the joint's ancestors to the list `joints` of the attachment's robot.
template <class S>
void add_path(const Scene& scene, const Attachment& at, AppliedForces<S>& forces) {
  if (at.robot < 0) return;
  std::vector<int>& joints = of_robot(scene, at.robot, forces).joints;
  for (int i = at.joint; i >= 0; i = scene.robots[at.robot].model->joints[i].parent) joints.push_back(i);
  std::sort(joints.begin(), joints.end());
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
}

// Returns the wrench about the tree frame's origin of a force at the point p and a torque.
template <class S>
Vec6<S> wrench_at(const Vec3<S>& p, const Vec3<S>& force, const Vec3<S>& torque) {
  Vec6<S> F;
  F.template head<3>() = force;
  F.template tail<3>() = add_cross(torque, p, force);
  return F;
}

template <class S>
void push(const ExternalWrench& push, const Kinematics<S>& kin, const Vec6<S>& w, Vec6<S>& F) {
  const SE3<S> M = kin.oMi[push.at.joint] * push.at.placement.template cast<S>();
  if (push.reference_frame == ReferenceFrame::kLocal)
    F = M.act_force(w);
  else
    F = wrench_at<S>(M.p, w.template head<3>(), w.template tail<3>());
}

// Returns the spring's force on its end A, and computes the members of s.
template <class S>
Vec3<S> stretch(const Spring& spring, const SpringEnd<S>& A, const SpringEnd<S>& B,
                typename AppliedForces<S>::OfSpring& s) {
  using std::sqrt;
  s.d = between(A, B);
  s.rate = A.velocity() - B.velocity();
  s.length = sqrt(s.d.squaredNorm());
  s.directed = true;
  s.n.setZero();
  s.t = S(0);
  if (spring.length != 0 || spring.damping != 0) {
    s.directed = s.length != S(0);
    s.n = s.d / s.length;
    s.t = S(spring.damping) * s.n.dot(s.rate) - S(spring.stiffness) * S(spring.length);
  }
  return Vec3<S>(s.d * S(-spring.stiffness) - s.n * s.t);
}

}  // namespace

template <class S>
AppliedForces<S>::AppliedForces(const Scene& scene)
    : number(scene.robots.size(), -1), wrenches(scene.wrenches.size()), springs(scene.springs.size()) {
  for (std::size_t k = 0; k < scene.wrenches.size(); ++k) {
    of_robot(scene, scene.wrenches[k].at.robot, *this).wrenches.push_back(static_cast<int>(k));
    add_path(scene, scene.wrenches[k].at, *this);
  }
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    of_robot(scene, scene.springs[k].A.robot, *this).springs.push_back(static_cast<int>(k));
    add_path(scene, scene.springs[k].A, *this);
    add_path(scene, scene.springs[k].B, *this);
  }
  for (std::size_t k = 0; k < scene.joint_springs.size(); ++k)
    of_robot(scene, scene.joint_springs[k].robot, *this).joint_springs.push_back(static_cast<int>(k));
}

template <class S>
void find_applied_wrenches(const Scene& scene, const S* q, const S* v, std::span<const Vec6<S>> w,
                           AppliedForces<S>& forces) {
  using Map = Eigen::Map<const VecX<S>>;
  for (auto& of : forces.robots) {
    if (of.joints.empty()) continue;
    const Robot& robot = scene.robots[of.robot];
    forward_kinematics<S>(*robot.model, robot.base, Map(q + robot.idx_q, robot.model->nq), of.kin);
    forward_accelerations<S>(*robot.model, Map(v + robot.idx_v, robot.model->nv), nullptr, scene.gravity, of.kin);
    for (int i : of.joints) of.f[i].setZero();
  }
  for (std::size_t k = 0; k < scene.wrenches.size(); ++k) {
    const Attachment& at = scene.wrenches[k].at;
    auto& of = forces.robots[forces.number[at.robot]];
    push<S>(scene.wrenches[k], of.kin, w[k], forces.wrenches[k]);
    of.f[at.joint] += forces.wrenches[k];
  }
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    const Spring& spring = scene.springs[k];
    const SpringEnd<S> A = spring_end<S>(spring.A, forces), B = spring_end<S>(spring.B, forces);
    const Vec3<S> force = stretch<S>(spring, A, B, forces.springs[k]), none = Vec3<S>::Zero();
    forces.robots[forces.number[spring.A.robot]].f[spring.A.joint] += wrench_at<S>(A.p, force, none);
    if (spring.B.robot >= 0)
      forces.robots[forces.number[spring.B.robot]].f[spring.B.joint] -= wrench_at<S>(B.p, force, none);
  }
}

template <class S>
void add_applied_forces(const Scene& scene, const S* q, const S* v, std::span<const Vec6<S>> w,
                        AppliedForces<S>& forces, S* tau) {
  find_applied_wrenches<S>(scene, q, v, w, forces);
  for (auto& of : forces.robots) {
    const Robot& robot = scene.robots[of.robot];
    S* torque = tau + robot.idx_v;
    for (std::size_t k = of.joints.size(); k-- > 0;) {
      const int i = of.joints[k];
      const Joint& joint = robot.model->joints[i];
      for (int c = joint.idx_v; c < joint.idx_v + joint.nv(); ++c) torque[c] += dot(of.kin.J.col(c), of.f[i]);
      if (joint.parent >= 0) of.f[joint.parent] += of.f[i];
    }
    for (int k : of.joint_springs) {
      const JointSpring& spring = scene.joint_springs[k];
      const Joint& joint = robot.model->joints[spring.joint];
      torque[joint.idx_v] -= S(spring.stiffness) * (q[robot.idx_q + joint.idx_q] - S(spring.rest));
    }
  }
}

using Real = InstantiatedScalar;
template struct AppliedForces<Real>;
template void find_applied_wrenches<Real>(const Scene&, const Real*, const Real*, std::span<const Vec6<Real>>,
                                          AppliedForces<Real>&);
template void add_applied_forces<Real>(const Scene&, const Real*, const Real*, std::span<const Vec6<Real>>,
                                       AppliedForces<Real>&, Real*);

}  // namespace manycontact
