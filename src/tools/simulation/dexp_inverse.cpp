#include "internal.hpp"
#include "manycontact/spatial/motion.hpp"

namespace manycontact::internal {

namespace {

// [w, v] on SE(2), for (x, y, angle): w's turn moves v's translation and the other way round.
Vec3<double> bracket_se2(const Vec3<double>& w, const Vec3<double>& v) {
  return {w[1] * v[2] - w[2] * v[1], w[2] * v[0] - w[0] * v[2], 0};
}

template <class Vector, class Bracket>
Vector series(const Vector& w, const Vector& v, Bracket&& bracket) {
  const Vector once = bracket(w, v), twice = bracket(w, once);
  return v + once / 2 + twice / 12;
}

}  // namespace

void dexp_inverse(const Scene& scene, const Eigen::VectorXd& w, const Eigen::VectorXd& v, Eigen::VectorXd& out) {
  out = v;  // joints of one coordinate commute
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints) {
      const int i = robot.idx_v + joint.idx_v;
      if (joint.type == JointType::kFloating) {
        out.segment<6>(i) = series<Vec6<double>>(
            w.segment<6>(i), v.segment<6>(i),
            [](const Vec6<double>& x, const Vec6<double>& y) { return Vec6<double>(cross_motion(x, y)); });
      } else if (joint.type == JointType::kPlanar) {
        out.segment<3>(i) = series<Vec3<double>>(w.segment<3>(i), v.segment<3>(i), bracket_se2);
      }
    }
}

}  // namespace manycontact::internal
