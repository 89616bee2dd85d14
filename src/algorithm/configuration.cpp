#include "manycontact/algorithm/configuration.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "manycontact/algorithm/integrate.hpp"

namespace manycontact {

namespace {

using ConstRef = Eigen::Ref<const Eigen::VectorXd>;

void check_size(const char* function, const char* what, Eigen::Index given, int expected) {
  if (given != expected)
    throw std::invalid_argument(std::string(function) + ": " + what + " has " + std::to_string(given) +
                                " numbers, the scene expects " + std::to_string(expected));
}

}  // namespace

Eigen::VectorXd neutral(const Scene& scene) {
  Eigen::VectorXd q(scene.nq);
  for (const Robot& robot : scene.robots) {
    q.segment(robot.idx_q, robot.model->nq) = neutral(*robot.model);
    if (robot.model->floating_base) q.segment<7>(robot.idx_q) = pose_of_placement(robot.base);
  }
  return q;
}

namespace {

double uniform(double low, double high, std::mt19937& generator) {
  const double t = std::generate_canonical<double, 53>(generator);
  return (1 - t) * low + t * high;  // finite for any finite limits
}

// Coordinate k of a joint that has limits; `reach`: how far from 0, or from one limit twice as far.
double within_limits(const Joint& joint, int k, double reach, std::mt19937& generator) {
  const auto finite = [k](const Eigen::VectorXd& limit) { return k < limit.size() && std::isfinite(limit[k]); };
  double low = -reach, high = reach;
  if (finite(joint.lower)) low = joint.lower[k], high = low + 2 * reach;
  if (finite(joint.upper)) high = joint.upper[k];
  if (finite(joint.upper) && !finite(joint.lower)) low = high - 2 * reach;
  return uniform(low, high, generator);
}

// Uniform on the unit quaternions. Source: Shoemake, Uniform random rotations, Graphics Gems III (1992).
Eigen::Vector4d random_quaternion(std::mt19937& generator) {
  const double s = uniform(0, 1, generator), pi = std::numbers::pi;
  const double a = uniform(-pi, pi, generator), b = uniform(-pi, pi, generator);
  const double r = std::sqrt(1 - s), t = std::sqrt(s);
  return {r * std::sin(a), r * std::cos(a), t * std::sin(b), t * std::cos(b)};
}

}  // namespace

Eigen::VectorXd random_configuration(const Scene& scene, std::mt19937& generator) {
  Eigen::VectorXd q(scene.nq);
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints) {
      auto x = q.segment(robot.idx_q + joint.idx_q, joint.nq());
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

void integrate(const Scene& scene, const ConstRef& q, const ConstRef& v, Eigen::Ref<Eigen::VectorXd> out) {
  check_size("integrate", "q", q.size(), scene.nq);
  check_size("integrate", "v", v.size(), scene.nv);
  check_size("integrate", "out", out.size(), scene.nq);
  for (const Robot& r : scene.robots)
    integrate<double>(*r.model, q.segment(r.idx_q, r.model->nq), v.segment(r.idx_v, r.model->nv),
                      out.segment(r.idx_q, r.model->nq));
}

Eigen::VectorXd integrate(const Scene& scene, const ConstRef& q, const ConstRef& v) {
  Eigen::VectorXd out(scene.nq);
  integrate(scene, q, v, out);
  return out;
}

void difference(const Scene& scene, const ConstRef& q0, const ConstRef& q1, Eigen::Ref<Eigen::VectorXd> out) {
  check_size("difference", "q0", q0.size(), scene.nq);
  check_size("difference", "q1", q1.size(), scene.nq);
  check_size("difference", "out", out.size(), scene.nv);
  for (const Robot& r : scene.robots)
    difference<double>(*r.model, q0.segment(r.idx_q, r.model->nq), q1.segment(r.idx_q, r.model->nq),
                       out.segment(r.idx_v, r.model->nv));
}

Eigen::VectorXd difference(const Scene& scene, const ConstRef& q0, const ConstRef& q1) {
  Eigen::VectorXd out(scene.nv);
  difference(scene, q0, q1, out);
  return out;
}

}  // namespace manycontact
