// Placement, velocity, acceleration and Jacobian of frames agree in every choice of axes, with each other and with
// differences of the placement in quadruple precision.

#include "manycontact/detail/algorithm/frames.hpp"

#include <gtest/gtest.h>

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/detail/algorithm/energy.hpp"
#include "support/random.hpp"

namespace manycontact {
namespace {

constexpr ReferenceFrame kAxes[] = {ReferenceFrame::kLocal, ReferenceFrame::kWorld, ReferenceFrame::kLocalWorldAligned};

struct FramesTest : testing::TestWithParam<bool> {
  std::mt19937 rng{7};
  Model model;
  SE3<double> base{rotation_about<double>(Vec3<double>(1, 2, 2) / 3, 0.4), Vec3<double>(3, -2, 1)};
  SE3<double> placement{rotation_about<double>(Vec3<double>(2, -1, 2) / 3, 0.9), Vec3<double>(0.1, 0.2, -0.3)};
  VecX<Quad> q, v, qdd;
  int joint = 0;

  void SetUp() override {
    test::ModelOptions options;
    options.floating_base = GetParam();
    model = test::random_model(rng, options);
    q = test::random_configuration(model, rng).cast<Quad>();
    std::normal_distribution<double> normal;
    const auto random = [&] {
      return VecX<Quad>(VecX<double>::NullaryExpr(model.nv, [&] { return normal(rng); }).cast<Quad>());
    };
    v = random();
    qdd = random();
    joint = model.njoints() - 1;
  }
  // Returns the motion at time t along q (+) (v t + qdd t^2/2), to second order in t.
  Kinematics<Quad> at(const Quad& t) const {
    Kinematics<Quad> kin(model);
    VecX<Quad> moved(model.nq);
    integrate<Quad>(model, q, VecX<Quad>(v * t + qdd * (t * t / 2)), moved);
    forward_kinematics<Quad>(model, base, moved, kin);
    forward_accelerations<Quad>(model, VecX<Quad>(v + qdd * t), qdd.data(), Vec3<double>(0, 0, -9.81), kin);
    return kin;
  }
};

TEST_P(FramesTest, JacobianTimesVelocityIsTheVelocity) {
  const Kinematics<Quad> kin = at(0);
  for (ReferenceFrame axes : kAxes) {
    Mat6X<Quad> J(6, model.nv);
    frame_jacobian<Quad>(model, kin, base, joint, placement, axes, J);
    const Vec6<Quad> velocity = frame_velocity<Quad>(kin, base, joint, placement, axes);
    EXPECT_GT(velocity.norm(), Quad(1e-3));
    EXPECT_LT(static_cast<double>((J * v - velocity).norm() / velocity.norm()), 1e-29);
  }
}

TEST_P(FramesTest, VelocityAndClassicalAccelerationAreThoseOfTheOrigin) {
  const Quad h(1e-9);
  const auto origin = [&](const Quad& t) { return frame_placement<Quad>(at(t), base, joint, placement).p; };
  const Kinematics<Quad> kin = at(0);
  const Vec3<Quad> velocity = (origin(h) - origin(-h)) / (2 * h);
  const Vec3<Quad> acceleration = (origin(h) - 2 * origin(0) + origin(-h)) / (h * h);
  const Vec6<Quad> v0 = frame_velocity<Quad>(kin, base, joint, placement, ReferenceFrame::kLocalWorldAligned);
  const Vec6<Quad> a0 =
      frame_classical_acceleration<Quad>(kin, base, joint, placement, ReferenceFrame::kLocalWorldAligned);
  EXPECT_LT(static_cast<double>((v0.head<3>() - velocity).norm() / velocity.norm()), 1e-14);
  EXPECT_LT(static_cast<double>((a0.head<3>() - acceleration).norm() / acceleration.norm()), 1e-12);
}

TEST_P(FramesTest, SpatialAccelerationIsTheDerivativeOfSpatialVelocity) {
  const Quad h(1e-12);
  for (ReferenceFrame axes :
       {ReferenceFrame::kLocal, ReferenceFrame::kWorld}) {  // those in which the components' derivative is spatial
    const auto velocity = [&](const Quad& t) { return frame_velocity<Quad>(at(t), base, joint, placement, axes); };
    const Vec6<Quad> difference = (velocity(h) - velocity(-h)) / (2 * h);
    const Vec6<Quad> a = frame_acceleration<Quad>(at(0), base, joint, placement, axes);
    // the model's rotations are orthonormal, its axes of unit length, to double precision only
    EXPECT_LT(static_cast<double>((a - difference).norm() / a.norm()), 1e-14);
  }
}

TEST_P(FramesTest, MomentumIsMassTimesVelocityOfTheCentreOfMass) {
  const Quad h(1e-10);
  const Vec3<Quad> velocity = (center_of_mass<Quad>(at(h)) - center_of_mass<Quad>(at(-h))) / (2 * h);
  const Vec6<Quad> p = momentum<Quad>(at(0));
  EXPECT_LT(static_cast<double>((p.head<3>() - Quad(model.mass()) * velocity).norm() / p.head<3>().norm()), 1e-13);
}

INSTANTIATE_TEST_SUITE_P(Bases, FramesTest, testing::Bool(),
                         [](const auto& info) { return info.param ? "floating" : "fixed"; });

}  // namespace
}  // namespace manycontact
