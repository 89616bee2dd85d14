#include "manycontact/model/expect_state.hpp"

#include <cmath>

#include "manycontact/model/suggestion.hpp"

namespace manycontact {

using ConstRef = ConstVectorRef;

namespace {

// Returns "q[3] is nan, a finite number is expected", or "" if all numbers are finite.
std::string not_finite(const char* what, const ConstRef& x) {
  if (x.allFinite()) return "";
  Eigen::Index i = 0;
  while (std::isfinite(x[i])) ++i;
  return std::string(what) + "[" + std::to_string(i) + "] is " + std::to_string(x[i]) + ", a finite number is expected";
}

void refuse(const char* function, const std::string& why) {
  if (!why.empty()) throw std::invalid_argument(std::string(function) + ": " + why);
}

}  // namespace

std::string unusable_configuration(const char* what, const ConstRef& q, const RigidBodies& bodies, double tolerance) {
  if (const std::string why = not_finite(what, q); !why.empty()) return why;
  for (const Robot& robot : bodies.robots()) {
    if (robot.model->nq == robot.model->nv) continue;  // a robot without quaternion
    for (const Joint& joint : robot.model->joints) {
      if (joint.type != JointType::kFloating) continue;
      const int first = bodies.idx_q(robot) + joint.idx_q + 3;
      const double length = q.segment<4>(first).norm();
      if (std::abs(length - 1) > tolerance)
        return std::string(what) + "[" + std::to_string(first) + "] to [" + std::to_string(first + 3) +
               "], the quaternion of joint " + quote(joint.name) + " of robot " + quote(robot.name) +
               ", have the length " + std::to_string(length) + ", a unit quaternion x y z w is expected";
    }
  }
  return "";
}

void expect_configuration(const char* function, const char* what, const ConstRef& q, const RigidBodies& bodies) {
  expect_size(function, what, q.size(), bodies.nq());
  if (q.allFinite() && bodies.nq() == bodies.nv()) return;
  refuse(function, unusable_configuration(what, q, bodies));
}

void expect_numbers(const char* function, const char* what, const ConstRef& x, Eigen::Index size) {
  expect_size(function, what, x.size(), size);
  refuse(function, not_finite(what, x));
}

}  // namespace manycontact
