#include <Eigen/Eigenvalues>

#include "manycontact/sparse/union_find.hpp"
#include "momentum_steps.hpp"

namespace manycontact {

using namespace internal;

namespace {

constexpr double kParallel = 1e-12;   // sine of the angle between normals of parallel planes
constexpr double kNoInertia = 1e-12;  // axes with a smaller moment of inertia, relative to trace I, do not rotate

bool may_begin_group(const Joint& joint) {
  return joint.type == JointType::kFloating || (joint.type == JointType::kPlanar && joint.parent < 0);
}

// Returns whether rotors or friction act along the joint's coordinates, so that the joint transmits momentum.
bool has_own_forces(const Model& model, const Joint& joint) {
  const auto any = [&](const Eigen::VectorXd& x) {
    return x.size() > 0 && !x.segment(joint.idx_v, joint.nv()).isZero(0);
  };
  return any(model.armature) || any(model.damping) || any(model.friction);
}

int node_of(const FreeGroups& groups, const Attachment& at) {
  return moves(at) ? groups.node[groups.first_body[at.robot] + at.joint] : 0;
}

Mat3<double> axes_of(const Robot& robot, const Joint& joint, const Kinematics<double>& kin) {
  const Mat3<double>& parent = joint.parent < 0 ? robot.base.R : kin.oMi[joint.parent].R;
  return robot.model->floating_base && joint.idx_v == 0 ? Mat3<double>(Mat3<double>::Identity())
                                                        : Mat3<double>(parent * joint.placement.R);
}

void hold_in_plane(FreeGroup& group, const Vec3<double>& normal) {
  if (!group.in_plane)
    group.in_plane = true, group.normal = normal;
  else if (group.normal.cross(normal).norm() > kParallel)
    group.tied = true;
}

// Returns whether a contact constrains its end to a plane, as a 1D contact in world axes does.
bool holds_in_plane(const Contact& c) {
  return c.type == ContactType::k1D && c.reference_frame != ReferenceFrame::kLocal;
}

// Merges nodes (sets of bodies without free joints between them) into groups if contacts, or motors, friction or rotors
// of the free joints, couple them.
void join_nodes(const Scene& scene, const std::vector<char>& active, FreeGroups& groups) {
  sparse::UnionFind sets(groups.group);
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    const Model& model = *scene.robots[j.robot].model;
    const Joint& joint = model.joints[j.joint];
    if (has_own_forces(model, joint) || (joint.parent >= 0 && joint.actuated)) sets.join(j.node, j.parent);
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (!active[c]) continue;
    const int a = node_of(groups, scene.contacts[c].A), b = node_of(groups, scene.contacts[c].B);
    if ((a != 0 && b != 0) || !holds_in_plane(scene.contacts[c])) sets.join(a, b);
  }
  for (std::size_t i = 0; i < groups.group.size(); ++i) groups.group[i] = sets.root(static_cast<int>(i));
}

// Finds the groups that are tied to the world or constrained to a plane.
void find_groups(const Scene& scene, const std::vector<char>& active, const std::vector<Kinematics<double>>& kin,
                 FreeGroups& groups) {
  (void)find_free_groups(scene, active, groups);
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    FreeGroup& group = group_at(groups, j.node);
    group.in_plane = false;
    group.reference = kin[j.robot].origin(j.joint);
  }
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    const Robot& robot = scene.robots[j.robot];
    const Joint& joint = robot.model->joints[j.joint];
    if (joint.type == JointType::kPlanar)
      hold_in_plane(group_at(groups, j.node), axes_of(robot, joint, kin[j.robot]).col(2));
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    const int a = node_of(groups, contact.A), b = node_of(groups, contact.B);
    if (active[c] && (a == 0 || b == 0) && holds_in_plane(contact))
      hold_in_plane(group_at(groups, std::max(a, b)), contact.axis);
  }
}

void displace(const Scene& scene, const std::vector<Kinematics<double>>& kin, FreeGroups& groups, Eigen::VectorXd& q) {
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    const Robot& robot = scene.robots[j.robot];
    const Joint& joint = robot.model->joints[j.joint];
    const Vec3<double> along = axes_of(robot, joint, kin[j.robot]).transpose() * added_displacement(groups, j);
    const int n = joint.type == JointType::kPlanar ? 2 : 3;
    q.segment(robot.idx_q + joint.idx_q, n) += along.head(n);
  }
}

void accelerate(const Scene& scene, const std::vector<Kinematics<double>>& kin, FreeGroups& groups,
                Eigen::VectorXd& v) {
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    const Robot& robot = scene.robots[j.robot];
    const Joint& joint = robot.model->joints[j.joint];
    const SE3<double>& M = kin[j.robot].oMi[j.joint];
    const Vec6<double> dv = added_velocity(groups, j, kin[j.robot].origin(j.joint) + M.p);
    const Vec3<double> linear = M.R.transpose() * dv.head<3>(), angular = M.R.transpose() * dv.tail<3>();
    auto of_joint = v.segment(robot.idx_v + joint.idx_v, joint.nv());
    add_motion(joint, linear, angular, of_joint);
  }
}

// Adds the impulse of a free joint's torques to the groups on both sides of the joint. C_next must still equal C.
void add_torques_of(const Scene& scene, const FreeGroups::FreeJoint& j, const Eigen::Ref<const Eigen::VectorXd>& tau,
                    double h, const std::vector<Kinematics<double>>& kin, FreeGroups& groups) {
  const Robot& robot = scene.robots[j.robot];
  const Joint& joint = robot.model->joints[j.joint];
  const Vec6<double> wrench = as_floating(joint, tau.segment(robot.idx_v + joint.idx_v, joint.nv()));
  const SE3<double>& M = kin[j.robot].oMi[j.joint];
  each_side(groups, j, [&](FreeGroup& group, double sign) {
    const SE3<double> about_C{M.R, kin[j.robot].origin(j.joint) + M.p - group.reference - group.C_next};
    const Vec6<double> impulse = sign * h * about_C.act_force(wrench);
    group.P_next += impulse.head<3>();
    group.L_next += impulse.tail<3>();
  });
}

}  // namespace

namespace internal {

bool find_free_groups(const Scene& scene, const std::vector<char>& active, FreeGroups& groups) {
  join_nodes(scene, active, groups);
  groups.any = false;
  for (FreeGroup& group : groups.groups) group.tied = true;
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    FreeGroup& group = group_at(groups, j.node);
    group.tied = groups.group[j.node] == groups.group[0];
    groups.any = groups.any || !group.tied;
  }
  return groups.any;
}

void measure(const Scene& scene, const std::vector<Kinematics<double>>& kin, FreeGroups& groups) {
  for (FreeGroup& group : groups.groups) group.Y = {}, group.momentum.setZero();
  for (std::size_t r = 0; r < scene.robots.size(); ++r)
    for (int i = 0; i < scene.robots[r].model->njoints(); ++i) {
      FreeGroup& group = group_at(groups, groups.node[groups.first_body[r] + i]);
      if (group.tied) continue;
      const Vec3<double> at = kin[r].origin(i) - group.reference;
      Vec6<double> h = kin[r].Y[i] * kin[r].v[i];
      h.tail<3>() += at.cross(Vec3<double>(h.head<3>()));
      group.Y += kin[r].Y[i].seen_at(at);
      group.momentum += h;
    }
}

Vec3<double> spin(const FreeGroup& group, const Vec3<double>& C) {
  return group.momentum.tail<3>() - C.cross(Vec3<double>(group.momentum.head<3>()));
}

void in_the_plane(const FreeGroup& group, Vec3<double>& x) {
  if (group.in_plane) x -= group.normal * group.normal.dot(x);
}

Vec3<double> turn_for(const FreeGroup& group, const Mat3<double>& I, const Vec3<double>& dL) {
  if (group.in_plane) {
    const double about = group.normal.dot(I * group.normal);
    return about > kNoInertia * I.trace() ? Vec3<double>(group.normal * (group.normal.dot(dL) / about))
                                          : Vec3<double>(Vec3<double>::Zero());
  }
  const Eigen::SelfAdjointEigenSolver<Mat3<double>> principal(I);
  Vec3<double> along = principal.eigenvectors().transpose() * dL;
  for (int k = 0; k < 3; ++k)
    along[k] = principal.eigenvalues()[k] > kNoInertia * I.trace() ? along[k] / principal.eigenvalues()[k] : 0;
  return principal.eigenvectors() * along;
}

void kinematics_at(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                   std::vector<Kinematics<double>>& kin) {
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const Robot& robot = scene.robots[r];
    const Model& model = *robot.model;
    forward_kinematics<double>(model, robot.base, q.segment(robot.idx_q, model.nq), kin[r]);
    forward_accelerations<double>(model, v.segment(robot.idx_v, model.nv), nullptr, scene.gravity, kin[r]);
  }
}

Vec3<double> place_of(const Attachment& at, const std::vector<Kinematics<double>>& kin) {
  if (at.robot < 0) return at.placement.p;
  const SE3<double>& M = kin[at.robot].oMi[at.joint];
  return kin[at.robot].origin(at.joint) + M.p + M.R * at.placement.p;
}

OneBody one_body(std::span<const int> members, const FreeGroups& groups) {
  OneBody out;
  Vec3<double> first = Vec3<double>::Zero(), P = first, L = first;
  for (const int g : members) {
    const FreeGroup& group = groups.groups[g];
    out.m += group.Y.m, first += group.Y.m * centre_of(group), P += group.momentum.head<3>();
    if (group.in_plane) out.plane.in_plane = true, out.plane.normal = group.normal;
  }
  out.C = first / out.m;
  for (const int g : members) {
    const FreeGroup& group = groups.groups[g];
    const Vec3<double> r = centre_of(group) - out.C;
    out.I += joint_space_inertia(group) + group.Y.m * (r.squaredNorm() * Mat3<double>::Identity() - r * r.transpose());
    L += spin(group, group.Y.h / group.Y.m) + r.cross(Vec3<double>(group.momentum.head<3>()));
  }
  out.V = P / out.m, out.w = turn_for(out.plane, out.I, L);
  return out;
}

Vec3<double> added_displacement(const FreeGroups& groups, const FreeGroups::FreeJoint& j) {
  Vec3<double> out = Vec3<double>::Zero();
  each_side(groups, j, [&](const FreeGroup& group, double sign) { out += sign * group.d; });
  return out;
}

Vec6<double> added_velocity(const FreeGroups& groups, const FreeGroups::FreeJoint& j, const Vec3<double>& at) {
  Vec6<double> out = Vec6<double>::Zero();
  each_side(groups, j, [&](const FreeGroup& group, double sign) {
    const Vec3<double> lever = at - group.reference - group.Y.h / group.Y.m;
    out.head<3>() += sign * (group.dv + group.dw.cross(lever));
    out.tail<3>() += sign * group.dw;
  });
  return out;
}

}  // namespace internal

FreeGroups::FreeGroups(const Scene& scene) {
  int nodes = 1;  // node 0 is the world
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const Model& model = *scene.robots[r].model;
    first_body.push_back(static_cast<int>(node.size()));
    for (int i = 0; i < model.njoints(); ++i) {
      const Joint& joint = model.joints[i];
      const int above = joint.parent < 0 ? 0 : node[first_body[r] + joint.parent];
      if (may_begin_group(joint)) joints.push_back({static_cast<int>(r), i, nodes, above});
      node.push_back(may_begin_group(joint) ? nodes++ : above);
    }
  }
  group.resize(static_cast<std::size_t>(nodes));
  groups.resize(static_cast<std::size_t>(nodes));
}

void begin_free_motion(const Scene& scene, const std::vector<char>& active,
                       const Eigen::Ref<const Eigen::VectorXd>& tau, double h,
                       const std::vector<Kinematics<double>>& kin, FreeGroups& groups) {
  find_groups(scene, active, kin, groups);
  measure(scene, kin, groups);
  groups.any = groups.nested = false;
  for (FreeGroup& group : groups.groups) {
    group.tied = group.tied || !(group.Y.m > 0);
    if (group.tied) continue;
    groups.any = true;
    group.C_next = group.Y.h / group.Y.m;
    group.P_next = group.momentum.head<3>() + h * group.Y.m * scene.gravity;
    group.L_next = spin(group, group.C_next);
  }
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    groups.nested = groups.nested || scene.robots[j.robot].model->joints[j.joint].parent >= 0;
    add_torques_of(scene, j, tau, h, kin, groups);
  }
  for (FreeGroup& group : groups.groups)
    if (!group.tied) group.C_next += h / group.Y.m * group.P_next;
}

void end_free_motion(const Scene& scene, Eigen::VectorXd& q, Eigen::VectorXd& v, std::vector<Kinematics<double>>& kin,
                     FreeGroups& groups) {
  if (!groups.any) return;
  kinematics_at(scene, q, v, kin);
  measure(scene, kin, groups);
  for (FreeGroup& group : groups.groups) {
    if (group.tied) continue;
    group.d = group.C_next - group.Y.h / group.Y.m;
    in_the_plane(group, group.d);
  }
  displace(scene, kin, groups, q);
  if (groups.nested) kinematics_at(scene, q, v, kin), measure(scene, kin, groups);
  for (FreeGroup& group : groups.groups) {
    if (group.tied) continue;
    const Vec3<double> C = group.Y.h / group.Y.m;
    group.dv = (group.P_next - group.momentum.head<3>()) / group.Y.m;
    in_the_plane(group, group.dv);
    group.dw = turn_for(group, group.Y.seen_at(-C).I, group.L_next - spin(group, C));
  }
  accelerate(scene, kin, groups, v);
}

}  // namespace manycontact
