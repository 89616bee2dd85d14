#pragma once
// Classical fourth-order Runge-Kutta integrates q and v with the quaternions' own derivative, so the order is kept on
// every joint. Energy and momentum are computed from velocities of bodies, without M.

#include <functional>

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"

namespace manycontact::test {

/// Returns dq/dt of a scene's q at velocity v.
inline Eigen::VectorXd q_rate(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  Eigen::VectorXd out(scene.nq);
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints) {
      const int iq = robot.idx_q + joint.idx_q, iv = robot.idx_v + joint.idx_v;
      if (joint.type == JointType::kFloating) {
        const Eigen::Quaterniond o(q[iq + 6], q[iq + 3], q[iq + 4], q[iq + 5]);
        out.segment<3>(iq) = o.normalized() * v.segment<3>(iv);
        out.segment<4>(iq + 3) = 0.5 * (o * Eigen::Quaterniond(0, v[iv + 3], v[iv + 4], v[iv + 5])).coeffs();
      } else if (joint.type == JointType::kPlanar) {
        out.segment<2>(iq) = Eigen::Rotation2Dd(q[iq + 2]) * v.segment<2>(iv);
        out[iq + 2] = v[iv + 2];
      } else {
        out[iq] = v[iv];
      }
    }
  return out;
}

inline void normalize_quaternions(const Scene& scene, Eigen::VectorXd& q) {
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints)
      if (joint.type == JointType::kFloating) q.segment<4>(robot.idx_q + joint.idx_q + 3).normalize();
}

/// Mechanical state of the whole scene. Momentum is about the world's origin.
struct Mechanics {
  double mass = 0, kinetic = 0, potential = 0;
  Vec3<double> first_moment = Vec3<double>::Zero();  // sum of m c
  Vec3<double> linear = Vec3<double>::Zero(), angular = Vec3<double>::Zero();

  double energy() const { return kinetic + potential; }
  Vec3<double> spin() const { return angular - (first_moment / mass).cross(linear); }  // about the centre of mass
};

inline Mechanics mechanics(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  Mechanics out;
  for (const Robot& robot : scene.robots) {
    const Model& model = *robot.model;
    Kinematics<double> kin(model);
    forward_kinematics<double>(model, robot.base, q.segment(robot.idx_q, model.nq), kin);
    forward_accelerations<double>(model, v.segment(robot.idx_v, model.nv), nullptr, scene.gravity, kin);
    for (int i = 0; i < model.njoints(); ++i) {
      const Vec6<double> momentum = kin.Y[i] * kin.v[i];
      const Vec3<double> moment = kin.Y[i].h + kin.Y[i].m * kin.origin(i);
      out.mass += kin.Y[i].m;
      out.first_moment += moment;
      out.kinetic += 0.5 * momentum.dot(kin.v[i]);
      out.potential -= scene.gravity.dot(moment);
      out.linear += momentum.head<3>();
      out.angular += momentum.tail<3>() + kin.origin(i).cross(Vec3<double>(momentum.head<3>()));
    }
    const Eigen::VectorXd vr = v.segment(robot.idx_v, model.nv);
    out.kinetic += 0.5 * (model.armature.array() * vr.array().square()).sum();  // the rotors rotate as well
  }
  return out;
}

/// Returns the part of v that every active contact allows, J v = 0.
inline Eigen::VectorXd consistent(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  const Eigen::MatrixXd J = contact_jacobian(scene, q);
  if (J.rows() == 0) return v;
  return v - least_norm(J, J * v);
}

/// A scene in motion under constant torques. `work` is their work since the start.
struct Simulation {
  Simulation(const Scene& scene_, Eigen::VectorXd q_, Eigen::VectorXd v_, Eigen::VectorXd u_, const Options& options)
      : scene(scene_), q(std::move(q_)), v(std::move(v_)), u(std::move(u_)), data(scene_, options) {}

  void step(double h) {
    struct Rate {
      Eigen::VectorXd q, v;
      double power;
    };
    const auto rate = [&](Eigen::VectorXd at_q, const Eigen::VectorXd& at_v) {
      normalize_quaternions(scene, at_q);
      (void)solve(scene, at_q, at_v, u, data);
      worst = std::max(worst, data.report.status);
      return Rate{q_rate(scene, at_q, at_v), data.a, power(at_v)};
    };
    const Rate k1 = rate(q, v);
    const Rate k2 = rate(q + 0.5 * h * k1.q, v + 0.5 * h * k1.v);
    const Rate k3 = rate(q + 0.5 * h * k2.q, v + 0.5 * h * k2.v);
    const Rate k4 = rate(q + h * k3.q, v + h * k3.v);
    q += h / 6 * (k1.q + 2 * k2.q + 2 * k3.q + k4.q);
    v += h / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v);
    work += h / 6 * (k1.power + 2 * k2.power + 2 * k3.power + k4.power);
    normalize_quaternions(scene, q);
  }
  double power(const Eigen::VectorXd& at_v) const {
    double p = 0;
    for (const Robot& r : scene.robots)
      p += u.segment(r.idx_u, r.model->nu()).dot(at_v.segment(r.idx_v + r.model->first_actuated(), r.model->nu()));
    return p;
  }

  const Scene& scene;
  Eigen::VectorXd q, v, u;
  SceneData data;
  double work = 0;
  Status worst = Status::kOk;
};

/// Adds a contact that fixes A where it is relative to B.
inline void hold(RandomScene& s, const std::string& name, ContactType type, Attachment A, Attachment B) {
  Contact c;
  c.name = name;
  c.type = type;
  c.A = A;
  c.B = B;
  resolve_reference(s.scene, s.q, true, true, c);
  add_contact(s.scene, c);
}

}  // namespace manycontact::test
