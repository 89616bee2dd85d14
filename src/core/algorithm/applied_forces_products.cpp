// Products with the derivatives of the torques of external wrenches and springs.

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/spatial/motion.hpp"
#include "spring_end.hpp"

namespace manycontact {

namespace {

using V3 = Vec3<double>;
using V6 = Vec6<double>;
using Forces = AppliedForces<double>;

V3 linear(const V6& x) { return x.head<3>(); }
V3 angular(const V6& x) { return x.tail<3>(); }
V6 joined(const V3& linear, const V3& angular) {
  V6 out;
  out << linear, angular;
  return out;
}
// Returns the linear motion of the body's point p. The adjoint from_point returns the wrench of a force at p.
V3 at_point(const V6& motion, const V3& p) { return linear(motion) + angular(motion).cross(p); }
V6 from_point(const V3& force, const V3& p) { return joined(force, p.cross(force)); }

// Returns the sum of S_j x_j over the coordinates j of one joint.
V6 own_motion(const Joint& joint, const Mat6X<double>& S, const double* x) {
  V6 out = V6::Zero();
  for (int c = joint.idx_v; c < joint.idx_v + joint.nv(); ++c) out += S.col(c) * x[c];
  return out;
}

// Calls use(of, index) for those of `robots` on which forces act. `of` is the entry `index` of forces.robots.
template <class Use>
void each_robot(const Forces& forces, std::span<const int> robots, Use&& use) {
  for (int r : robots)
    if (const int k = forces.number[r]; k >= 0) use(forces.robots[k], static_cast<std::size_t>(k));
}

// An end of a spring, and pointers to its body's u, x, v in AppliedScratch, which are nullptr for an end in the world.
struct End {
  SpringEnd<double> at;
  V6 *u = nullptr, *x = nullptr, *v = nullptr;
};
End end_of(const Forces& forces, const Attachment& at, AppliedScratch& s) {
  const SpringEnd<double> end = spring_end<double>(at, forces);
  if (at.robot < 0) return {end};
  const int k = forces.number[at.robot];
  return {end, &s.u[k][at.joint], &s.x[k][at.joint], &s.v[k][at.joint]};
}

// Calls push(wrench, number, of, index) for external wrenches on these robots, where forces.robots[index] = of is the
// robot's entry, and spring(spring, number, end A, end B) for springs whose end A is on these robots.
template <class OfPush, class OfSpring>
void each_force(const Scene& scene, const Forces& forces, std::span<const int> robots, AppliedScratch& scratch,
                OfPush&& push, OfSpring&& spring) {
  each_robot(forces, robots, [&](const Forces::OfRobot& of, std::size_t k) {
    for (int p : of.wrenches) push(scene.wrenches[p], p, of, k);
    for (int p : of.springs)
      spring(scene.springs[p], p, end_of(forces, scene.springs[p].A, scratch),
             end_of(forces, scene.springs[p].B, scratch));
  });
}

// ---- tangent: displacement x and velocity change v of each body, then the change df of its force, stored in u -----

void add_push_tangent(const ExternalWrench& push, const Forces::OfRobot& of, const V6& F, const double* dw, const V6& x,
                      V6& df) {
  const SE3<double> M = of.kin.oMi[push.at.joint] * push.at.placement;
  const bool local = push.reference_frame == ReferenceFrame::kLocal;
  if (local)
    df += cross_force(x, F);  // the wrench is fixed to the body and rotates with it
  else
    df.tail<3>() += at_point(x, M.p).cross(linear(F));
  if (!dw) return;
  const Eigen::Map<const V6> change(dw);
  df += local ? M.act_force(change) : joined(change.head<3>(), change.tail<3>() + M.p.cross(V3(change.head<3>())));
}

void add_spring_tangent(const Spring& spring, const Forces::OfSpring& s, const End& A, const End& B) {
  V3 dp[2], rate[2];
  const End* ends[] = {&A, &B};
  for (int e = 0; e < 2; ++e) {
    const End& end = *ends[e];
    dp[e] = end.x ? at_point(*end.x, end.at.p) : V3::Zero();
    rate[e] = end.x ? V3(at_point(*end.v, end.at.p) + angular(end.at.body).cross(dp[e])) : V3::Zero();
  }
  const V3 dd = dp[0] - dp[1], drate = rate[0] - rate[1];
  const V3 force = -spring.stiffness * s.d - s.t * s.n;
  V3 dforce = -spring.stiffness * dd;
  if (spring.length != 0 || spring.damping != 0) {
    const V3 dn = (dd - s.n * s.n.dot(dd)) / s.length;
    dforce -= spring.damping * (dn.dot(s.rate) + s.n.dot(drate)) * s.n + s.t * dn;
  }
  *A.u += joined(dforce, dp[0].cross(force) + A.at.p.cross(dforce));
  if (B.u) *B.u -= joined(dforce, dp[1].cross(force) + B.at.p.cross(dforce));
}

// ---- adjoint: u of each body, then the gradients with respect to x and v ------------------------------------------

void add_push_adjoint(const ExternalWrench& push, const Forces::OfRobot& of, const V6& F, const V6& u, V6& x,
                      double* ww) {
  const SE3<double> M = of.kin.oMi[push.at.joint] * push.at.placement;
  if (push.reference_frame == ReferenceFrame::kLocal) {
    x -= cross_force(u, F);
    if (ww) Eigen::Map<V6>{ww} = M.act_inverse(u);
  } else {
    x += from_point(linear(F).cross(angular(u)), M.p);
    if (ww) Eigen::Map<V6>{ww} = joined(at_point(u, M.p), angular(u));
  }
}

void add_spring_adjoint(const Spring& spring, const Forces::OfSpring& s, const End& A, const End& B) {
  const V3 force = -spring.stiffness * s.d - s.t * s.n;
  // g: gradient with respect to the force on A
  const V3 g = at_point(*A.u, A.at.p) - (B.u ? at_point(*B.u, B.at.p) : V3::Zero());
  V3 by_d = -spring.stiffness * g, by_rate = V3::Zero();
  if (spring.length != 0 || spring.damping != 0) {
    const double by_speed = -spring.damping * s.n.dot(g);  // gradient with respect to d|d|/dt
    const V3 by_n = by_speed * s.rate - s.t * g;
    by_d += (by_n - s.n * s.n.dot(by_n)) / s.length;
    by_rate = by_speed * s.n;
  }
  const auto give = [&](const End& end, double sign) {
    const V3 by_p = sign * (by_d + force.cross(angular(*end.u)) + by_rate.cross(angular(end.at.body)));
    *end.x += from_point(by_p, end.at.p);
    *end.v += from_point(sign * by_rate, end.at.p);
  };
  give(A, 1);
  if (B.u) give(B, -1);
}

}  // namespace

AppliedScratch::AppliedScratch(const AppliedForces<double>& forces) {
  for (const Forces::OfRobot& of : forces.robots)
    for (auto* list : {&u, &x, &v}) list->emplace_back(of.f.size(), V6::Zero());
}

void add_applied_tangent(const Scene& scene, const double* v, const AppliedForces<double>& forces,
                         std::span<const int> robots, const double* dq, const double* dv, const double* dw,
                         AppliedScratch& scratch, double* dtau) {
  each_robot(forces, robots, [&](const Forces::OfRobot& of, std::size_t k) {
    const Robot& robot = scene.robots[of.robot];
    for (int i : of.joints) {
      const Joint& joint = robot.model->joints[i];
      V6 x = own_motion(joint, of.kin.J, dq + robot.idx_v), change = own_motion(joint, of.kin.J, dv + robot.idx_v);
      if (joint.parent >= 0) x += scratch.x[k][joint.parent], change += scratch.v[k][joint.parent];
      scratch.x[k][i] = x;
      scratch.v[k][i] = change + cross_motion(x, own_motion(joint, of.kin.J, v + robot.idx_v));
      scratch.u[k][i].setZero();
    }
  });
  each_force(
      scene, forces, robots, scratch,
      [&](const ExternalWrench& push, int p, const Forces::OfRobot& of, std::size_t k) {
        const int i = push.at.joint;
        add_push_tangent(push, of, forces.wrenches[p], dw ? dw + 6 * p : nullptr, scratch.x[k][i], scratch.u[k][i]);
      },
      [&](const Spring& spring, int p, const End& A, const End& B) {
        add_spring_tangent(spring, forces.springs[p], A, B);
      });
  each_robot(forces, robots, [&](const Forces::OfRobot& of, std::size_t k) {
    const Robot& robot = scene.robots[of.robot];
    for (std::size_t j = of.joints.size(); j-- > 0;) {
      const int i = of.joints[j];
      const Joint& joint = robot.model->joints[i];
      for (int c = joint.idx_v; c < joint.idx_v + joint.nv(); ++c)
        dtau[robot.idx_v + c] +=
            of.kin.J.col(c).dot(scratch.u[k][i]) + cross_motion(scratch.x[k][i], of.kin.J.col(c)).dot(of.f[i]);
      if (joint.parent >= 0) scratch.u[k][joint.parent] += scratch.u[k][i];
    }
    for (int p : of.joint_springs) {
      const int i = robot.idx_v + robot.model->joints[scene.joint_springs[p].joint].idx_v;
      dtau[i] -= scene.joint_springs[p].stiffness * dq[i];
    }
  });
}

void add_applied_adjoint(const Scene& scene, const double* v, const AppliedForces<double>& forces,
                         std::span<const int> robots, const double* l, AppliedScratch& scratch, double* wq, double* wv,
                         double* ww) {
  each_robot(forces, robots, [&](const Forces::OfRobot& of, std::size_t k) {
    const Robot& robot = scene.robots[of.robot];
    for (int i : of.joints) {  // computes u, and sets x to the gradient of (xi x S l)^T f
      const Joint& joint = robot.model->joints[i];
      const V6 own = own_motion(joint, of.kin.J, l + robot.idx_v);
      scratch.u[k][i] = joint.parent >= 0 ? V6(scratch.u[k][joint.parent] + own) : own;
      scratch.x[k][i] = cross_force(own, of.f[i]);
      scratch.v[k][i].setZero();
    }
  });
  each_force(
      scene, forces, robots, scratch,
      [&](const ExternalWrench& push, int p, const Forces::OfRobot& of, std::size_t k) {
        const int i = push.at.joint;
        add_push_adjoint(push, of, forces.wrenches[p], scratch.u[k][i], scratch.x[k][i], ww ? ww + 6 * p : nullptr);
      },
      [&](const Spring& spring, int p, const End& A, const End& B) {
        add_spring_adjoint(spring, forces.springs[p], A, B);
      });
  each_robot(forces, robots, [&](const Forces::OfRobot& of, std::size_t k) {
    const Robot& robot = scene.robots[of.robot];
    for (std::size_t j = of.joints.size(); j-- > 0;) {
      const int i = of.joints[j];
      const Joint& joint = robot.model->joints[i];
      V6 &x = scratch.x[k][i], &change = scratch.v[k][i];
      x += cross_force(own_motion(joint, of.kin.J, v + robot.idx_v), change);  // adds the derivative of xi x S v
      for (int c = joint.idx_v; c < joint.idx_v + joint.nv(); ++c) {
        wq[robot.idx_v + c] += of.kin.J.col(c).dot(x);
        wv[robot.idx_v + c] += of.kin.J.col(c).dot(change);
      }
      if (joint.parent >= 0) scratch.x[k][joint.parent] += x, scratch.v[k][joint.parent] += change;
    }
    for (int p : of.joint_springs) {
      const int i = robot.idx_v + robot.model->joints[scene.joint_springs[p].joint].idx_v;
      wq[i] -= scene.joint_springs[p].stiffness * l[i];
    }
  });
}

}  // namespace manycontact
