#include <set>

#include "manycontact/algorithm/inertia_factor.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

std::vector<int> massless_coordinates(const Robot& robot, const ConstVectorRef& q) {
  const Model& model = *robot.model;
  Kinematics<double> kin(model);
  std::vector<Inertia<double>> Yc;
  std::vector<double> M(packed_size(model));
  forward_kinematics<double>(model, robot.base, q, kin);
  crba<double>(model, kin, Yc, M.data());
  Eigen::VectorXd diagonal(model.nv);
  return factorize_inertia(model, M.data(), diagonal.data());
}

namespace {

bool is_nothing(const Inertia<double>& Y) { return Y.m == 0 && Y.h.isZero(0) && Y.I.isZero(0); }

// Returns whether all inertias and armatures in the subtree of joint i are zero.
bool nothing_below(const Model& model, int i) {
  for (int j = i; j < model.subtree_end[i]; ++j) {
    const Joint& joint = model.joints[j];
    if (!is_nothing(joint.inertia) || !model.armature.segment(joint.idx_v, joint.nv()).isZero(0)) return false;
  }
  return true;
}

// Returns the missing property if a joint moves without resistance: mass, moment of inertia, ...
std::string lacking(JointType type) {
  switch (type) {
    case JointType::kPrismatic:
      return "mass";
    case JointType::kRevolute:
      return "a moment of inertia about the joint's axis";
    default:
      return "mass or a moment of inertia";
  }
}

std::string why_massless(const Model& model, int i) {
  if (nothing_below(model, i)) return "there is no mass below the joint";
  const std::string own = "the joint's bodies lack " + lacking(model.joints[i].type);
  return model.subtree_end[i] == i + 1 ? own : own + ", and the joints below can move all other bodies";
}

std::set<int> massless_of(const Robot& robot, const ConstVectorRef& q) {
  const Model& model = *robot.model;
  std::set<int> joints;
  if (model.nv > 0 && model.M_begin.empty()) {
    for (int i = 0; i < model.njoints(); ++i)
      if (nothing_below(model, i)) joints.insert(i);
  } else {
    for (const int k : massless_coordinates(robot, q)) joints.insert(model.dof_joint[k]);
  }
  return joints;
}

}  // namespace

std::vector<MasslessJoint> massless_joints(const Scene& scene, const SceneData& data, const ConstVectorRef& q) {
  std::vector<MasslessJoint> out;
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
    const IslandReport& report = data.report.islands[i];
    if (report.status != Status::kFailed || report.reason != Reason::kSingularInertia) continue;
    for (int r : solved_island(data, i).robots) {
      const Robot& robot = scene.robots[r];
      for (const int j : massless_of(robot, q.segment(robot.idx_q, robot.model->nq)))
        out.push_back({robot.name + "/" + robot.model->joints[j].name, why_massless(*robot.model, j)});
    }
  }
  return out;
}

}  // namespace manycontact
