#include "manycontact/simulation/momentum_derivatives.hpp"

#include <algorithm>

#include "momentum_steps.hpp"

namespace manycontact {

using namespace internal;

namespace {

using OfGroup = FreeMotionDerivatives::OfGroup;

// Transforms a motion about the origin of the tree frame to the motion about the point p.
Vec6<double> seen_at(const Vec6<double>& motion, const Vec3<double>& p) {
  Vec6<double> out = motion;
  out.head<3>() += motion.tail<3>().cross(p);
  return out;
}

Vec3<double> com_of(const FreeGroup& group) { return group.Y.h / group.Y.m; }  // centre of mass, from its reference

// Calls use(coordinate, its column of kin.J) for the coordinates of joint i and of all joints above it.
template <class Use>
void each_above(const Robot& robot, int i, const Kinematics<double>& kin, Use&& use) {
  const Model& model = *robot.model;
  for (; i >= 0; i = model.joints[i].parent)
    for (int k = model.joints[i].idx_v; k < model.joints[i].idx_v + model.joints[i].nv(); ++k)
      use(robot.idx_v + k, kin.J.col(k));
}

// Computes the bodies of a group that each joint of robot r carries, and derivatives of the group's momentum.
void differentiate_robot(const Scene& scene, int r, int root, const std::vector<Kinematics<double>>& kin,
                         const FreeGroups& groups, const FreeGroup& group, FreeMotionDerivatives& d, OfGroup& out) {
  const Robot& robot = scene.robots[r];
  const Model& model = *robot.model;
  const Kinematics<double>& k = kin[r];
  for (int i = 0; i < model.njoints(); ++i) d.carried[i] = {{}, Vec6<double>::Zero()};
  for (int i = model.njoints(); i-- > 0;) {
    FreeMotionDerivatives::Carried& own = d.carried[i];
    const Vec3<double> at = k.origin(i) - group.reference;
    const std::size_t node = static_cast<std::size_t>(groups.node[groups.first_body[r] + i]);
    if (groups.group[node] == root) {
      Vec6<double> h = k.Y[i] * k.v[i];
      h.tail<3>() += at.cross(Vec3<double>(h.head<3>()));
      own.Y += k.Y[i].seen_at(at);
      own.h += h;
    }
    const Joint& joint = model.joints[i];
    const Vec6<double> V = joint.parent < 0 ? Vec6<double>(Vec6<double>::Zero()) : seen_at(k.v[joint.parent], -at);
    for (int c = joint.idx_v; c < joint.idx_v + joint.nv(); ++c) {
      const Vec6<double> S = seen_at(k.J.col(c), -at);
      out.h_v.col(robot.idx_v + c) = own.Y * S;
      out.h_q.col(robot.idx_v + c) = cross_force(S, own.h) - own.Y * cross_motion(S, V);
    }
    if (joint.parent < 0) continue;
    d.carried[joint.parent].Y += own.Y;
    d.carried[joint.parent].h += own.h;
  }
}

// Computes derivatives of C, P and L of each free group at the state of `kin`. Requires `measure` at this state.
void differentiate_momentum(const Scene& scene, const std::vector<Kinematics<double>>& kin, const FreeGroups& groups,
                            FreeMotionDerivatives& d) {
  for (std::size_t g = 0; g < d.groups.size(); ++g) {
    const FreeGroup& group = groups.groups[g];
    OfGroup& out = d.groups[g];
    out.robots.clear();
    if (group.tied) continue;
    for (int r = 0; r < scene.nrobots(); ++r) {
      const int njoints = scene.robots[r].model->njoints();
      const auto first = groups.node.begin() + groups.first_body[r];
      if (std::any_of(first, first + njoints, [&](int node) { return groups.group[node] == static_cast<int>(g); }))
        out.robots.push_back(r);
    }
    const Vec3<double> C = com_of(group), P = group.momentum.head<3>();
    for (int r : out.robots) {
      differentiate_robot(scene, r, static_cast<int>(g), kin, groups, group, d, out);
      for (int c = scene.robots[r].idx_v; c < scene.robots[r].idx_v + scene.robots[r].model->nv; ++c) {
        out.C_q.col(c) = out.h_v.col(c).head<3>() / group.Y.m;
        // L = L_reference - C x P is differentiated
        out.h_q.col(c).tail<3>() -=
            Vec3<double>(out.C_q.col(c)).cross(P) + C.cross(Vec3<double>(out.h_q.col(c).head<3>()));
        out.h_v.col(c).tail<3>() -= C.cross(Vec3<double>(out.h_v.col(c).head<3>()));
      }
    }
  }
}

bool is_free(const FreeGroups& groups, std::size_t g) { return !groups.groups[g].tied; }

OfGroup& of_group(FreeMotionDerivatives& d, const FreeGroups& groups, const FreeGroup& group) {
  return d.groups[&group - groups.groups.data()];
}

// Adds the derivatives of P+ and L+ that result from a free joint's torques and from the point at which they act.
void differentiate_torques(const Scene& scene, const FreeGroups::FreeJoint& j,
                           const Eigen::SparseMatrix<double>& dtau_dx, const Eigen::SparseMatrix<double>& dtau_dw,
                           const Eigen::Ref<const Eigen::VectorXd>& tau, double h,
                           const std::vector<Kinematics<double>>& kin, FreeGroups& groups, FreeMotionDerivatives& d) {
  const Robot& robot = scene.robots[j.robot];
  const Joint& joint = robot.model->joints[j.joint];
  const int iv = robot.idx_v + joint.idx_v;
  const SE3<double>& M = kin[j.robot].oMi[j.joint];
  const Vec6<double> wrench = as_floating(joint, tau.segment(iv, joint.nv()));
  const Vec3<double> force = M.R * wrench.head<3>(), moment = M.R * wrench.tail<3>();
  each_side(groups, j, [&](const FreeGroup& group, double sign) {
    OfGroup& out = of_group(d, groups, group);
    const Vec3<double> lever = kin[j.robot].origin(j.joint) + M.p - group.reference - com_of(group);
    const auto add = [&](Eigen::Index column, const Vec3<double>& dP, const Vec3<double>& dL) {
      out.next.col(column).segment<3>(3) += sign * h * dP;
      out.next.col(column).tail<3>() += sign * h * dL;
    };
    each_above(robot, j.joint, kin[j.robot], [&](int column, const Vec6<double>& S) {
      const Vec3<double> turn = S.tail<3>(), turned = turn.cross(force), moved = seen_at(S, M.p).head<3>();
      add(column, turned, turn.cross(moment) + lever.cross(turned) + moved.cross(force));
    });
    for (int r : out.robots)
      for (int c = scene.robots[r].idx_v; c < scene.robots[r].idx_v + scene.robots[r].model->nv; ++c)
        add(c, Vec3<double>::Zero(), force.cross(Vec3<double>(out.C_q.col(c))));
    const auto by = [&](const Eigen::SparseMatrix<double>& B, Eigen::Index first) {
      for (Eigen::Index c = 0; c < B.outerSize(); ++c)
        for (Eigen::SparseMatrix<double>::InnerIterator it(B, c); it; ++it) {
          if (it.row() < iv || it.row() >= iv + joint.nv()) continue;
          Vec6<double> unit = Vec6<double>::Zero();
          unit[it.row() - iv] = it.value();
          const Vec6<double> w = as_floating(joint, unit.head(joint.nv()));
          const Vec3<double> f = M.R * w.head<3>();
          add(first + c, f, M.R * w.tail<3>() + lever.cross(f));
        }
    };
    by(dtau_dx, 0);
    by(dtau_dw, dtau_dx.cols());
  });
}

// Adds scale * block(:, c) * F(c, :) to `out`, where c are the velocity coordinates of `robots`.
template <class Block, class Rows>
void multiply(const Scene& scene, const std::vector<int>& robots, const Block& block, const Rows& F, double scale,
              Eigen::Ref<Eigen::MatrixXd> out) {
  for (int r : robots) {
    const int first = scene.robots[r].idx_v, nv = scene.robots[r].model->nv;
    out.noalias() += scale * (block.middleCols(first, nv).lazyProduct(F.middleRows(first, nv)));
  }
}

// Computes d.turned, the rotation of the joint's body: the angular columns of the coordinates above it, times F.
void turn(const Robot& robot, int joint, const Kinematics<double>& kin, const Eigen::MatrixXd& F,
          FreeMotionDerivatives& d) {
  d.turned.setZero();
  each_above(robot, joint, kin, [&](int column, const Vec6<double>& S) {
    d.turned.noalias() += Vec3<double>(S.tail<3>()) * F.row(column);
  });
}

// Computes the rows of q in F, T dq~ + E dd (momentum_derivatives.hpp).
void differentiate_displacement(const Scene& scene, const std::vector<Kinematics<double>>& kin,
                                const FreeGroups& groups, FreeMotionDerivatives& d, Eigen::MatrixXd& F) {
  for (const FreeGroups::FreeJoint& j : groups.joints) {  // T dq~
    const Robot& robot = scene.robots[j.robot];
    const Joint& joint = robot.model->joints[j.joint];
    if (joint.parent < 0) continue;
    const Mat3<double> R = kin[j.robot].oMi[j.joint].R.transpose();
    turn(robot, joint.parent, kin[j.robot], F, d);
    F.middleRows<3>(robot.idx_v + joint.idx_v).noalias() +=
        Mat3<double>(R * skew<double>(added_displacement(groups, j))).lazyProduct(d.turned);
  }
  const auto rows_of_q = F.topRows(scene.nv);
  for (std::size_t g = 0; g < d.groups.size(); ++g) {
    if (!is_free(groups, g)) continue;
    OfGroup& out = d.groups[g];
    out.added.topRows<3>() = out.next.topRows<3>();
    multiply(scene, out.robots, out.C_q, rows_of_q, -1, out.added.topRows<3>());
    for (Eigen::Index c = 0; c < out.added.cols(); ++c) {
      Vec3<double> along = out.added.col(c).head<3>();
      in_the_plane(groups.groups[g], along);
      out.added.col(c).head<3>() = along;
    }
  }
  for (const FreeGroups::FreeJoint& j : groups.joints) {  // E dd
    const Robot& robot = scene.robots[j.robot];
    const Joint& joint = robot.model->joints[j.joint];
    const Mat3<double> R = kin[j.robot].oMi[j.joint].R.transpose();
    const int n = joint.type == JointType::kPlanar ? 2 : 3;
    each_side(groups, j, [&](const FreeGroup& group, double sign) {
      F.middleRows(robot.idx_v + joint.idx_v, n).noalias() +=
          sign * R.topRows(n).lazyProduct(of_group(d, groups, group).added.topRows<3>());
    });
  }
}

// Adds a motion in world axes to the velocity rows of a joint in F, column by column.
template <class Linear, class Angular>
void add_motion_rows(const Scene& scene, const FreeGroups::FreeJoint& j, const Mat3<double>& to_child,
                     const Linear& linear, const Angular& angular, Eigen::MatrixXd& F) {
  const Robot& robot = scene.robots[j.robot];
  const Joint& joint = robot.model->joints[j.joint];
  for (Eigen::Index c = 0; c < F.cols(); ++c) {
    auto of_joint = F.col(c).segment(scene.nv + robot.idx_v + joint.idx_v, joint.nv());
    add_motion(joint, Vec3<double>(to_child * linear(c)), Vec3<double>(to_child * angular(c)), of_joint);
  }
}

// Computes the rows of v in F, dv~ + A_q dq+ (momentum_derivatives.hpp). R are the child's axes, p its origin, (u, w)
// the added motion, and C a group's centre of mass. If the child rotates by r (d.turned), R^T u changes by R^T (u x r),
// and R^T w likewise. If p and C move by dp and dC, u + w x (p - C) changes by w x (dp - dC).
void differentiate_added_motion(const Scene& scene, const std::vector<Kinematics<double>>& kin,
                                const FreeGroups& groups, FreeMotionDerivatives& d, Eigen::MatrixXd& F) {
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    const Robot& robot = scene.robots[j.robot];
    const Kinematics<double>& k = kin[j.robot];
    const SE3<double>& M = k.oMi[j.joint];
    const Vec6<double> added = added_velocity(groups, j, k.origin(j.joint) + M.p);
    const Vec3<double> u = added.head<3>(), w = added.tail<3>();
    turn(robot, j.joint, k, F, d);
    const Mat3<double> to_child = M.R.transpose();
    add_motion_rows(
        scene, j, to_child, [&](Eigen::Index c) { return Vec3<double>(u.cross(Vec3<double>(d.turned.col(c)))); },
        [&](Eigen::Index c) { return Vec3<double>(w.cross(Vec3<double>(d.turned.col(c)))); }, F);
    d.turned.setZero();  // d.turned becomes dp, the displacement of the child's origin
    each_above(robot, j.joint, k, [&](int column, const Vec6<double>& S) {
      d.turned.noalias() += Vec3<double>(seen_at(S, M.p).head<3>()) * F.row(column);
    });
    each_side(groups, j, [&](const FreeGroup& group, double sign) {
      const OfGroup& of = of_group(d, groups, group);
      add_motion_rows(
          scene, j, to_child,
          [&](Eigen::Index c) {
            return Vec3<double>(sign * group.dw.cross(Vec3<double>(d.turned.col(c) - of.added.col(c).head<3>())));
          },
          [](Eigen::Index) { return Vec3<double>(Vec3<double>::Zero()); }, F);
    });
  }
}

}  // namespace

FreeMotionDerivatives::FreeMotionDerivatives(const Scene& scene, const FreeGroups& of, Eigen::Index n)
    : groups(of.groups.size()), turned(3, n) {
  int most = 0;
  for (const Robot& robot : scene.robots) most = std::max(most, robot.model->njoints());
  carried.resize(static_cast<std::size_t>(most));
  for (std::size_t g = 1; g < groups.size(); ++g) {
    groups[g].robots.reserve(scene.robots.size());
    groups[g].next.resize(9, n);
    groups[g].added.resize(9, n);
    groups[g].h_q.resize(6, scene.nv);
    groups[g].h_v.resize(6, scene.nv);
    groups[g].C_q.resize(3, scene.nv);
  }
}

// Differentiates P+ = P + h m g + h force,  L+ = L + h moment,  C+ = C + h P+ / m.
void differentiate_begin(const Scene& scene, const Eigen::SparseMatrix<double>& dtau_dx,
                         const Eigen::SparseMatrix<double>& dtau_dw, const Eigen::Ref<const Eigen::VectorXd>& tau,
                         double h, const std::vector<Kinematics<double>>& kin, FreeGroups& groups,
                         FreeMotionDerivatives& d) {
  if (!groups.any) return;
  measure(scene, kin, groups);
  differentiate_momentum(scene, kin, groups, d);
  for (std::size_t g = 0; g < d.groups.size(); ++g) {
    if (!is_free(groups, g)) continue;
    OfGroup& out = d.groups[g];
    out.next.setZero();
    for (int r : out.robots) {
      const int first = scene.robots[r].idx_v, nv = scene.robots[r].model->nv;
      out.next.middleCols(first, nv).topRows<3>() = out.C_q.middleCols(first, nv);
      out.next.middleCols(first, nv).bottomRows<6>() = out.h_q.middleCols(first, nv);
      out.next.middleCols(scene.nv + first, nv).bottomRows<6>() = out.h_v.middleCols(first, nv);
    }
  }
  for (const FreeGroups::FreeJoint& j : groups.joints)
    differentiate_torques(scene, j, dtau_dx, dtau_dw, tau, h, kin, groups, d);
  for (std::size_t g = 0; g < d.groups.size(); ++g)
    if (is_free(groups, g))
      d.groups[g].next.topRows<3>() += h / groups.groups[g].Y.m * d.groups[g].next.middleRows<3>(3);
}

void differentiate_end(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                       std::vector<Kinematics<double>>& kin, FreeGroups& groups, FreeMotionDerivatives& d,
                       Eigen::MatrixXd& F) {
  if (!groups.any) return;
  kinematics_at(scene, q, v, kin);
  measure(scene, kin, groups);
  differentiate_momentum(scene, kin, groups, d);
  differentiate_displacement(scene, kin, groups, d, F);
  const auto rows_of_q = F.topRows(scene.nv), rows_of_v = F.bottomRows(scene.nv);
  const auto each_group = [&](auto&& use) {
    for (std::size_t g = 0; g < d.groups.size(); ++g)
      if (is_free(groups, g)) use(groups.groups[g], d.groups[g]);
  };
  each_group([&](const FreeGroup&, OfGroup& out) {  // dC at the end of the step
    out.added.topRows<3>().setZero();
    multiply(scene, out.robots, out.C_q, rows_of_q, 1, out.added.topRows<3>());
  });
  differentiate_added_motion(scene, kin, groups, d, F);
  each_group([&](const FreeGroup& group, OfGroup& out) {  // du, dw: added velocities
    auto left = out.added.bottomRows<6>();
    left = out.next.bottomRows<6>();
    multiply(scene, out.robots, out.h_q, rows_of_q, -1, left);
    multiply(scene, out.robots, out.h_v, rows_of_v, -1, left);
    const Mat3<double> I = group.Y.seen_at(-com_of(group)).I;
    Mat3<double> turn_by;
    for (int k = 0; k < 3; ++k) turn_by.col(k) = turn_for(group, I, Vec3<double>::Unit(k));
    for (Eigen::Index c = 0; c < left.cols(); ++c) {
      Vec3<double> u = left.col(c).head<3>() / group.Y.m;
      in_the_plane(group, u);
      left.col(c).head<3>() = u;
      left.col(c).tail<3>() = Vec3<double>(turn_by * left.col(c).tail<3>());
    }
  });
  for (const FreeGroups::FreeJoint& j : groups.joints) {  // A [du; dw]
    const SE3<double>& M = kin[j.robot].oMi[j.joint];
    const Vec3<double> at = kin[j.robot].origin(j.joint) + M.p;
    each_side(groups, j, [&](const FreeGroup& group, double sign) {
      const OfGroup& of = of_group(d, groups, group);
      const Vec3<double> lever = at - group.reference - com_of(group);
      add_motion_rows(
          scene, j, sign * M.R.transpose(),
          [&](Eigen::Index c) {
            const Vec3<double> w = of.added.col(c).tail<3>();
            return Vec3<double>(of.added.col(c).segment<3>(3) + w.cross(lever));
          },
          [&](Eigen::Index c) { return Vec3<double>(of.added.col(c).tail<3>()); }, F);
    });
  }
}

}  // namespace manycontact
