#include "manycontact/algorithm/configuration.hpp"

#include <cmath>
#include <numbers>

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact {

using ConstRef = ConstVectorRef;

Eigen::VectorXd neutral(const RigidBodies& bodies) {
  Eigen::VectorXd q(bodies.nq());
  for (const Robot& robot : bodies.robots()) {
    q.segment(bodies.idx_q(robot), robot.model->nq) = neutral(*robot.model);
    if (robot.model->floating_base) q.segment<7>(bodies.idx_q(robot)) = pose_of_placement(robot.base);
  }
  return q;
}

namespace {

double uniform(double low, double high, std::mt19937& generator) {
  const double t = std::generate_canonical<double, 53>(generator);
  return (1 - t) * low + t * high;  // finite for any finite low and high
}

// Samples coordinate k of a joint. reach: its largest magnitude without limits, half its range with one limit.
double within_limits(const Joint& joint, int k, double reach, std::mt19937& generator) {
  const auto finite = [k](const Eigen::VectorXd& limit) { return k < limit.size() && std::isfinite(limit[k]); };
  double low = -reach, high = reach;
  if (finite(joint.lower)) low = joint.lower[k], high = low + 2 * reach;
  if (finite(joint.upper)) high = joint.upper[k];
  if (finite(joint.upper) && !finite(joint.lower)) low = high - 2 * reach;
  return uniform(low, high, generator);
}

// Samples unit quaternions uniformly. Source: Shoemake, Uniform random rotations, Graphics Gems III (1992).
Eigen::Vector4d random_quaternion(std::mt19937& generator) {
  const double s = uniform(0, 1, generator), pi = std::numbers::pi;
  const double a = uniform(-pi, pi, generator), b = uniform(-pi, pi, generator);
  const double r = std::sqrt(1 - s), t = std::sqrt(s);
  return {r * std::sin(a), r * std::cos(a), t * std::sin(b), t * std::cos(b)};
}

}  // namespace

Eigen::VectorXd random_configuration(const RigidBodies& bodies, std::mt19937& generator) {
  Eigen::VectorXd q(bodies.nq());
  for (const Robot& robot : bodies.robots())
    for (const Joint& joint : robot.model->joints) {
      auto x = q.segment(bodies.idx_q(robot) + joint.idx_q, joint.nq());
      switch (joint.type) {
        case JointType::kRevolute:
          x[0] = within_limits(joint, 0, std::numbers::pi, generator);
          break;
        case JointType::kPrismatic:
          x[0] = within_limits(joint, 0, 1, generator);
          break;
        case JointType::kFloating:
          for (int k = 0; k < 3; ++k) x[k] = uniform(-1, 1, generator);
          x.tail<4>() = random_quaternion(generator);
          if (robot.model->floating_base && joint.idx_q == 0) x.head<3>() += robot.base.p;
          break;
        case JointType::kPlanar:
          for (int k = 0; k < 3; ++k) x[k] = within_limits(joint, k, k < 2 ? 1 : std::numbers::pi, generator);
          break;
      }
    }
  return q;
}

Eigen::VectorXd random_velocity(const RigidBodies& bodies, std::mt19937& generator) {
  Eigen::VectorXd v(bodies.nv());
  for (const Robot& robot : bodies.robots())
    for (const Joint& joint : robot.model->joints)
      for (int k = 0; k < joint.nv(); ++k) {
        const bool limited = joint.velocity_limit.size() == joint.nv() && joint.velocity_limit[k] > 0 &&
                             std::isfinite(joint.velocity_limit[k]);  // files write 0 for an unknown limit
        const double most = limited ? joint.velocity_limit[k] : 1;
        v[bodies.idx_v(robot) + joint.idx_v + k] = uniform(-most, most, generator);
      }
  return v;
}

void integrate(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v, VectorRef out) {
  expect_configuration("integrate", "q", q, bodies);
  expect_numbers("integrate", "v", v, bodies.nv());
  expect_size("integrate", "out", out.size(), bodies.nq());
  for (const Robot& r : bodies.robots())
    integrate<double>(*r.model, q.segment(bodies.idx_q(r), r.model->nq), v.segment(bodies.idx_v(r), r.model->nv),
                      out.segment(bodies.idx_q(r), r.model->nq));
}

Eigen::VectorXd integrate(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v) {
  Eigen::VectorXd out(bodies.nq());
  integrate(bodies, q, v, out);
  return out;
}

void difference(const RigidBodies& bodies, const ConstRef& q0, const ConstRef& q1, VectorRef out) {
  expect_configuration("difference", "q0", q0, bodies);
  expect_configuration("difference", "q1", q1, bodies);
  expect_size("difference", "out", out.size(), bodies.nv());
  for (const Robot& r : bodies.robots())
    difference<double>(*r.model, q0.segment(bodies.idx_q(r), r.model->nq), q1.segment(bodies.idx_q(r), r.model->nq),
                       out.segment(bodies.idx_v(r), r.model->nv));
}

Eigen::VectorXd difference(const RigidBodies& bodies, const ConstRef& q0, const ConstRef& q1) {
  Eigen::VectorXd out(bodies.nv());
  difference(bodies, q0, q1, out);
  return out;
}

Eigen::VectorXd interpolate(const RigidBodies& bodies, const ConstRef& q0, const ConstRef& q1, double share) {
  if (!std::isfinite(share)) throw std::invalid_argument("interpolate: a finite share is expected");
  return integrate(bodies, q0, share * difference(bodies, q0, q1));
}

namespace {

// Returns the block-diagonal matrix whose blocks J are set by block(joint, v of the joint, first, J) for each joint.
template <class Block>
Eigen::MatrixXd blocks(const RigidBodies& bodies, const Eigen::VectorXd& v, bool first, Block&& block) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(v.size(), v.size());
  for (const Robot& robot : bodies.robots())
    for (const Joint& joint : robot.model->joints) {
      const int at = bodies.idx_v(robot) + joint.idx_v, n = joint.nv();
      block(joint, v.segment(at, n), first, out.block(at, at, n, n));
    }
  return out;
}

}  // namespace

IntegrateDerivatives integrate_derivatives(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v) {
  expect_configuration("integrate_derivatives", "q", q, bodies);
  expect_numbers("integrate_derivatives", "v", v, bodies.nv());
  return {blocks(bodies, v, true, joint_integrate_derivative), blocks(bodies, v, false, joint_integrate_derivative)};
}

DifferenceDerivatives difference_derivatives(const RigidBodies& bodies, const ConstRef& q0, const ConstRef& q1) {
  const Eigen::VectorXd v = difference(bodies, q0, q1);
  return {blocks(bodies, v, true, joint_difference_derivative), blocks(bodies, v, false, joint_difference_derivative)};
}

}  // namespace manycontact
