// Magnitudes of the terms of applied forces (external wrenches, springs) and of their derivatives. The terms may cancel
// and leave rounding errors. Derivatives are bounded with the largest motion of a body by any coordinate above it.

#include <algorithm>
#include <cmath>

#include "manycontact/algorithm/applied_forces.hpp"
#include "spring_end.hpp"

namespace manycontact {

namespace {

using V3 = Vec3<double>;
using Forces = AppliedForces<double>;

double largest(const ConstVectorRef& x) { return x.cwiseAbs().maxCoeff(); }

// The largest magnitudes of motions, or of forces, about a tree frame's origin.
struct Size {
  double linear = 0, angular = 0;

  void add(double l, double a) { linear += l, angular += a; }
  void add(const Size& other) { add(other.linear, other.angular); }
  double at(double lever) const { return linear + angular * lever; }  // largest motion at this distance
};

struct OfBody {
  Size moved, velocity;    // moved: largest motion by one coordinate; velocity: sum over coordinates
  double lever = 0;        // largest distance from the tree frame's origin to a joint between the body and the base
  Size force, by_q, by_v;  // forces on the body's subtree; derivatives with respect to one coordinate
};

// An end of a spring. For an end in the world, all members but `lever` and `reach` are zero.
struct OfEnd {
  OfBody* body = nullptr;
  double lever = 0;               // distance from the tree frame's origin to the end
  double reach = 0;               // largest distance from this origin to the end, or to a joint above the end's body
  double speed = 0;               // bound of the end's speed
  double velocity = 0;            // sum over coordinates of the speed that each coordinate gives the end
  double moved = 0, changed = 0;  // largest change of the position, and of the velocity, by one coordinate
};

OfEnd end_of(const SpringEnd<double>& end, OfBody* body) {
  const double lever = largest(end.p);
  OfEnd out{body, lever, lever};
  if (!body) return out;
  const Size& v = body->velocity;
  out.reach = std::max(lever, body->lever);
  out.speed = largest(end.body.head<3>()) + largest(end.body.tail<3>()) * out.lever;
  out.velocity = v.at(out.reach);
  out.moved = body->moved.at(out.reach);
  out.changed = body->moved.angular * v.at(out.reach) + body->moved.linear * v.angular + v.angular * out.moved;
  return out;
}

Size size_of_column(const Kinematics<double>& kin, int joint, int coordinate) {
  const double turning = largest(kin.J.col(coordinate).tail<3>());
  return {std::max(largest(kin.J.col(coordinate).head<3>()), turning * largest(kin.oMi[joint].p)), turning};
}

class Sizes {
 public:
  Sizes(const Scene& scene, const double* q, const double* v, const Forces& forces, std::span<const int> robots)
      : scene_(scene), forces_(forces), bodies_(forces.robots.size()) {
    for (std::vector<double>* x : {&out_.tau, &out_.q, &out_.v, &out_.w}) x->assign(scene.nv, 0.0);
    each(robots, [&](const Forces::OfRobot& of, std::vector<OfBody>& bodies) { add_motions(of, v, bodies); });
    each(robots, [&](const Forces::OfRobot& of, std::vector<OfBody>& bodies) {
      for (int k : of.wrenches)
        add_external_wrench(scene.wrenches[k], forces.wrenches[k], of, bodies[scene.wrenches[k].at.joint]);
      for (int k : of.springs) add_spring(scene.springs[k], forces.springs[k]);
    });
    each(robots, [&](const Forces::OfRobot& of, std::vector<OfBody>& bodies) {
      take_torques(of, bodies);
      for (int k : of.joint_springs) add_joint_spring(scene.joint_springs[k], q);
    });
  }
  AppliedSizes take() { return std::move(out_); }

 private:
  template <class Use>
  void each(std::span<const int> robots, Use&& use) {
    for (int r : robots)
      if (const int k = forces_.number[r]; k >= 0) use(forces_.robots[k], bodies_[k]);
  }

  void add_motions(const Forces::OfRobot& of, const double* v, std::vector<OfBody>& bodies) const {
    const Robot& robot = scene_.robots[of.robot];
    bodies.resize(robot.model->joints.size());
    for (int i : of.joints) {
      const Joint& joint = robot.model->joints[i];
      OfBody& body = bodies[i];
      if (joint.parent >= 0) {
        const OfBody& parent = bodies[joint.parent];
        body.moved = parent.moved, body.velocity = parent.velocity, body.lever = parent.lever;
      }
      body.lever = std::max(body.lever, largest(of.kin.oMi[i].p));
      for (int c = joint.idx_v; c < joint.idx_v + joint.nv(); ++c) {
        const Size column = size_of_column(of.kin, i, c);
        const double speed = std::abs(v[robot.idx_v + c]);
        body.moved = {std::max(body.moved.linear, column.linear), std::max(body.moved.angular, column.angular)};
        body.velocity.add(column.linear * speed, column.angular * speed);
      }
    }
  }

  static double reach_of(const ExternalWrench& push, const Forces::OfRobot& of) {
    return largest(of.kin.oMi[push.at.joint].p) + largest(push.at.placement.p);
  }

  static void add_external_wrench(const ExternalWrench& push, const Vec6<double>& F, const Forces::OfRobot& of,
                                  OfBody& body) {
    const double force = largest(F.head<3>()), reach = reach_of(push, of);
    const Size f{force, largest(F.tail<3>()) + reach * force}, &moved = body.moved;
    body.force.add(f);
    if (push.reference_frame == ReferenceFrame::kLocal)  // the wrench is fixed to the body and moves with it
      body.by_q.add(moved.angular * f.linear, moved.angular * f.angular + moved.linear * f.linear);
    else
      body.by_q.add(0, moved.at(std::max(reach, body.lever)) * force);
  }

  void add_spring(const Spring& spring, const Forces::OfSpring& s) {
    const auto body_of = [&](const Attachment& at) {
      return at.robot < 0 ? nullptr : &bodies_[forces_.number[at.robot]][at.joint];
    };
    const SpringEnd<double> at_A = spring_end<double>(spring.A, forces_), at_B = spring_end<double>(spring.B, forces_);
    const OfEnd A = end_of(at_A, body_of(spring.A)), B = end_of(at_B, body_of(spring.B));
    const double apart = largest(V3(at_B.origin.p - at_A.origin.p));
    const double place = A.lever + B.lever + apart, k = spring.stiffness, c = spring.damping;
    double force = k * (place + spring.length) + c * (A.speed + B.speed);
    const double moved = A.moved + B.moved;
    double by_q = k * moved, by_v = 0;
    if (spring.length != 0 || c != 0) {
      force += (std::abs(s.t) + c * largest(s.rate)) * (1 + place / s.length);
      const double turned = 1 + (A.reach + B.reach + apart) / s.length;
      const double velocity = A.velocity + B.velocity, dn = 2 * moved / s.length;
      by_q += turned * ((k * spring.length + 2 * c * velocity) * dn + c * (A.changed + B.changed));
      by_v = turned * c * moved;
    }
    for (const OfEnd* end : {&A, &B}) {
      if (!end->body) continue;
      end->body->force.add(force, force * end->lever);
      end->body->by_q.add(by_q, by_q * end->reach + force * end->moved);
      end->body->by_v.add(by_v, by_v * end->reach);
    }
  }

  // From the leaves to the root: magnitudes of tau_i = S_i^T f_i and its derivatives, which include (xi x S_i)^T f_i.
  void take_torques(const Forces::OfRobot& of, std::vector<OfBody>& bodies) {
    const Robot& robot = scene_.robots[of.robot];
    double reach = 0;
    for (int k : of.wrenches) reach = std::max({reach, 1.0, reach_of(scene_.wrenches[k], of)});
    for (std::size_t j = of.joints.size(); j-- > 0;) {
      const int i = of.joints[j];
      const Joint& joint = robot.model->joints[i];
      const OfBody& body = bodies[i];
      const Size& x = body.moved;
      for (int c = joint.idx_v; c < joint.idx_v + joint.nv(); ++c) {
        const Size s = size_of_column(of.kin, i, c);
        const auto of_forces = [&s](const Size& f) { return s.linear * f.linear + s.angular * f.angular; };
        const int at = robot.idx_v + c;
        out_.tau[at] += of_forces(body.force);
        out_.q[at] +=
            of_forces(body.by_q) + x.angular * of_forces(body.force) + x.linear * s.angular * body.force.linear;
        out_.v[at] += of_forces(body.by_v);
        if (reach > 0) out_.w[at] += s.at(reach);
      }
      if (joint.parent < 0) continue;
      OfBody& parent = bodies[joint.parent];
      parent.force.add(body.force), parent.by_q.add(body.by_q), parent.by_v.add(body.by_v);
    }
  }

  void add_joint_spring(const JointSpring& spring, const double* q) {
    const Robot& robot = scene_.robots[spring.robot];
    const Joint& joint = robot.model->joints[spring.joint];
    const int at = robot.idx_v + joint.idx_v;
    out_.tau[at] += spring.stiffness * (std::abs(q[robot.idx_q + joint.idx_q]) + std::abs(spring.rest));
    out_.q[at] += spring.stiffness;
  }

  const Scene& scene_;
  const Forces& forces_;
  std::vector<std::vector<OfBody>> bodies_;  // one entry per robot of the forces, each with njoints bodies
  AppliedSizes out_;
};

}  // namespace

AppliedSizes applied_sizes(const Scene& scene, const double* q, const double* v, const AppliedForces<double>& forces,
                           std::span<const int> robots) {
  return Sizes(scene, q, v, forces, robots).take();
}

}  // namespace manycontact
