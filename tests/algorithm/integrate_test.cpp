// The configuration manifold is tested.

#include <numbers>

#include "algorithm/shapes.hpp"
#include "manycontact/spatial/explog.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

class Manifold : public Robots {
 protected:
  VectorXd add(const VectorXd& q, const VectorXd& v) const {
    VectorXd out = VectorXd::Constant(model.nq, NAN);
    integrate<double>(model, q, v, out);
    return out;
  }
  VectorXd subtract(const VectorXd& q1, const VectorXd& q0) const {
    VectorXd out = VectorXd::Constant(model.nv, NAN);
    difference<double>(model, q0, q1, out);
    return out;
  }
  // Returns a step with no angular part longer than `angle`.
  VectorXd step(double angle) {
    VectorXd v = random_vector(model.nv, s.rng).cwiseMax(-3).cwiseMin(3);
    return v * (angle / (3 * std::sqrt(3.0)));
  }
};

INSTANTIATE_TEST_SUITE_P(Of, Manifold, testing::ValuesIn(shapes()), shape_name);

TEST_P(Manifold, NoVelocityNoMotion) {
  EXPECT_LE(difference_of(add(s.q, VectorXd::Zero(model.nv)), s.q), 4 * kEps);
  EXPECT_LE(size_of(subtract(s.q, s.q)), 8 * kEps);
}

TEST_P(Manifold, DifferenceUndoesIntegrate) {
  for (double angle : {1e-9, 1e-4, 0.1, 1.0, 3.1}) {
    const VectorXd v = step(angle);
    EXPECT_LE(difference_of(subtract(add(s.q, v), s.q), v), kTight) << angle;
  }
}

TEST_P(Manifold, IntegrateUndoesDifference) {
  const VectorXd other = add(s.q, step(3.0));
  const VectorXd back = add(s.q, subtract(other, s.q));
  EXPECT_LE(size_of(subtract(back, other)), kTight);
}

TEST_P(Manifold, HalvesOfAStepAddUp) {
  const VectorXd v = step(2.0);
  EXPECT_LE(size_of(subtract(add(add(s.q, v / 2), v / 2), add(s.q, v))), kTight);
  EXPECT_LE(size_of(subtract(add(add(s.q, v), -v), s.q)), kTight);
}

TEST_P(Manifold, QuaternionsStayUnit) {
  VectorXd q = s.q;
  for (int k = 0; k < 1000; ++k) q = add(q, step(1.0));
  for (const Joint& joint : model.joints) {
    if (joint.type != JointType::kFloating) continue;
    EXPECT_NEAR(q.segment<4>(joint.idx_q + 3).norm(), 1, 4 * kEps);
  }
}

TEST(Integrate, FloatingJointMovesInItsOwnFrame) {
  Specimen s({.njoints = 1, .floating_base = true});
  const Vec6<double> v = s.v;
  VectorXd q(7);
  integrate<double>(s.model, s.q, s.v, q);
  const SE3<double> before{rotation_of_quaternion<double>(s.q[3], s.q[4], s.q[5], s.q[6]), s.q.head<3>()};
  const SE3<double> after{rotation_of_quaternion<double>(q[3], q[4], q[5], q[6]), q.head<3>()};
  EXPECT_LE(difference_of(after, before * exp6<double>(v)), kTight);
}

TEST(Integrate, PlanarJointMovesInItsOwnFrame) {
  Specimen s({.njoints = 1, .types = {JointType::kPlanar}});
  VectorXd q(3);
  integrate<double>(s.model, VectorXd(Vec3<double>(1, 2, std::numbers::pi / 2)), VectorXd(Vec3<double>(0.3, 0, 0)), q);
  EXPECT_LE(difference_of(q, Vec3<double>(1, 2.3, std::numbers::pi / 2)), 4 * kEps);  // its x is the plane's y
  integrate<double>(s.model, VectorXd(Vec3<double>::Zero()),
                    VectorXd(Vec3<double>(std::numbers::pi, 0, std::numbers::pi)), q);
  EXPECT_LE(difference_of(q, Vec3<double>(0, 2, std::numbers::pi)), 4 * kEps);  // half a circle of radius 1
}

}  // namespace
}  // namespace manycontact::test
