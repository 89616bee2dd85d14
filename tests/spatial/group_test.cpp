// Placements, motions and forces share properties: at the identity, near it (1e-8) and anywhere.

#include <gtest/gtest.h>

#include <string>

#include "manycontact/spatial/explog.hpp"
#include "manycontact/spatial/inertia.hpp"
#include "spatial/compare.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

using Matrix6 = Mat6<double>;
using Motion = Vec6<double>;
using Placement = SE3<double>;

constexpr double kTight = 32 * kEps;  // numbers of size 1 to 3, sums of up to six products of them
constexpr int kStates = 20;

class Group : public testing::TestWithParam<std::string> {
 protected:
  Placement placement() {
    if (GetParam() == "identity") return {};
    if (GetParam() == "tiny") return exp6<double>(1e-8 * motion());
    return random_placement(rng, 1);
  }
  Motion motion() { return random_vector(6, rng); }
  std::mt19937 rng{7};
};

INSTANTIATE_TEST_SUITE_P(At, Group, testing::Values("identity", "tiny", "random"),
                         [](const auto& info) { return info.param; });

TEST_P(Group, Axioms) {
  for (int trial = 0; trial < kStates; ++trial) {
    const Placement X = placement(), Y = placement(), Z = placement();
    EXPECT_LE(difference_of((X * Y) * Z, X * (Y * Z)), kTight);
    EXPECT_LE(difference_of(X * X.inverse(), Placement()), kTight);
    EXPECT_LE(difference_of(X.inverse() * X, Placement()), kTight);
    EXPECT_EQ(difference_of(X * Placement(), X), 0);
    EXPECT_EQ(difference_of(Placement() * X, X), 0);
    EXPECT_LE(difference_of((X * Y).inverse(), Y.inverse() * X.inverse()), kTight);
  }
}

TEST_P(Group, PosesAreItsCoordinates) {
  for (int trial = 0; trial < kStates; ++trial) {
    const Placement X = placement();
    const Eigen::Matrix<double, 7, 1> pose = pose_of_placement(X);
    EXPECT_EQ(difference_of(pose.head<3>(), X.p), 0);
    EXPECT_EQ(difference_of(pose.tail<4>(), quaternion_of_rotation<double>(X.R)), 0);
    EXPECT_LE(difference_of(placement_of_pose(pose), X), kTight);
    EXPECT_LE(difference_of(placement_of_pose(Eigen::VectorXd(pose)), X), kTight);
  }
}

TEST_P(Group, ActionIsAHomomorphism) {
  for (int trial = 0; trial < kStates; ++trial) {
    const Placement X = placement(), Y = placement();
    const Motion m = motion();
    EXPECT_LE(difference_of((X * Y).action(), Matrix6(X.action() * Y.action())), kTight);
    EXPECT_LE(difference_of(X.inverse().action(), Matrix6(inverse_of(X.action()))), kTight);
    EXPECT_LE(difference_of((X * Y).act(m), X.act(Y.act(m))), kTight);
    EXPECT_LE(difference_of(X.act(m), Motion(X.action() * m)), kTight);
    EXPECT_LE(difference_of(X.act_inverse(m), X.inverse().act(m)), kTight);
    EXPECT_LE(difference_of(X.act_inverse(X.act(m)), m), kTight);
  }
}

// Power f . m is the same in both frames.
TEST_P(Group, ForcesAreDualToMotions) {
  for (int trial = 0; trial < kStates; ++trial) {
    const Placement X = placement();
    const Motion f = motion(), m = motion();
    EXPECT_NEAR(X.act_force(f).dot(X.act(m)), f.dot(m), 4 * kTight);
    EXPECT_LE(difference_of(X.act_force(f), Motion(inverse_of(X.action()).transpose() * f)), kTight);
  }
}

// d/dt Ad(exp(t m)) = ad_m at t = 0, for forces minus its transpose; hence Ad(exp m) = e^(ad_m).
TEST_P(Group, CrossProductsAreTheDerivativeOfTheAction) {
  const double step = 1e-5;  // central differences: truncation step^2, rounding eps / step
  for (int trial = 0; trial < kStates; ++trial) {
    const Placement X = placement();
    const Motion m = motion(), x = motion();
    const Placement forth = exp6<double>(step * m) * X, back = exp6<double>(-step * m) * X;
    EXPECT_LE(difference_of(cross_motion(m, X.act(x)), Motion((forth.act(x) - back.act(x)) / (2 * step))), 1e-8);
    EXPECT_LE(
        difference_of(cross_force(m, X.act_force(x)), Motion((forth.act_force(x) - back.act_force(x)) / (2 * step))),
        1e-8);
    Matrix6 series = Matrix6::Identity(), term = series;
    for (int k = 1; k < 60; ++k) series += term = (cross_matrix<double>(m) * term / k).eval();
    EXPECT_LE(error_of(exp6<double>(m).action(), series), 1e3 * kEps);  // the series itself cancels
  }
}

TEST_P(Group, CrossProductsAreALieAlgebraOnWhichPlacementsAct) {
  for (int trial = 0; trial < kStates; ++trial) {
    const Placement X = placement();
    const Motion a = motion(), b = motion(), c = motion(), f = motion();
    EXPECT_LE(difference_of(cross_motion(a, b), Motion(-cross_motion(b, a))), kTight);
    EXPECT_LE(difference_of(cross_motion(a, b), Motion(cross_matrix<double>(a) * b)), kTight);
    EXPECT_LE(difference_of(cross_force(a, f), Motion(-cross_matrix<double>(a).transpose() * f)), kTight);
    EXPECT_NEAR(cross_force(a, f).dot(b), -f.dot(cross_motion(a, b)), 4 * kTight);
    EXPECT_LE(size_of(Motion(cross_motion(a, cross_motion(b, c)) + cross_motion(b, cross_motion(c, a)) +
                             cross_motion(c, cross_motion(a, b)))),
              8 * kTight);
    EXPECT_LE(difference_of(X.act(cross_motion(a, b)), cross_motion(X.act(a), X.act(b))), 8 * kTight);
    EXPECT_LE(difference_of(X.act_force(cross_force(a, f)), cross_force(X.act(a), X.act_force(f))), 8 * kTight);
  }
}

// ---- inertia is defined by a cloud of point masses ------------------------------------------------------------------

struct Cloud {
  std::vector<double> mass;
  std::vector<Vec3<double>> at;

  explicit Cloud(std::mt19937& rng) {
    for (int k = 0; k < 5; ++k) {
      mass.push_back(uniform(rng, 0.5, 2));
      at.push_back(random_vector(3, rng, 0.5));
    }
  }
  // The point moves with v + w x p; the matrix gives its momentum and the moment of that.
  Matrix6 matrix() const {
    Matrix6 Y = Matrix6::Zero();
    for (std::size_t k = 0; k < mass.size(); ++k) {
      Eigen::Matrix<double, 3, 6> V;
      V << Mat3<double>::Identity(), -skew<double>(at[k]);
      Y += mass[k] * V.transpose() * V;
    }
    return Y;
  }
  Inertia<double> inertia() const {
    double m = 0;
    Vec3<double> c = Vec3<double>::Zero();
    for (std::size_t k = 0; k < mass.size(); ++k) m += mass[k], c += mass[k] * at[k];
    c /= m;
    Mat3<double> Ic = Mat3<double>::Zero();
    for (std::size_t k = 0; k < mass.size(); ++k) Ic -= mass[k] * skew<double>(at[k] - c) * skew<double>(at[k] - c);
    return Inertia<double>::from_com(m, c, Ic);
  }
  Cloud seen_from(const Placement& aMb) const {
    Cloud moved = *this;
    for (Vec3<double>& p : moved.at) p = aMb.R * p + aMb.p;
    return moved;
  }
};

TEST_P(Group, InertiaOfPointMasses) {
  for (int trial = 0; trial < kStates; ++trial) {
    const Placement X = placement();
    const Cloud cloud(rng), other(rng);
    const Inertia<double> Y = cloud.inertia();
    const Motion m = motion();
    EXPECT_LE(error_of(Y.matrix(), cloud.matrix()), kTight);
    EXPECT_LE(difference_of(Y * m, Motion(Y.matrix() * m)), 8 * kTight);
    EXPECT_LE(error_of(Y.transformed(X).matrix(), cloud.seen_from(X).matrix()), kTight);
    const Matrix6 inverse = X.inverse().action();
    EXPECT_LE(error_of(Y.transformed(X).matrix(), Matrix6(inverse.transpose() * Y.matrix() * inverse)), kTight);
    EXPECT_LE(error_of((Y.transformed(X) * X.act(m)).eval(), X.act_force(Y * m)), kTight);
    Inertia<double> sum = Y;
    sum += other.inertia();
    EXPECT_LE(error_of(sum.matrix(), Matrix6(cloud.matrix() + other.matrix())), kTight);
  }
}

TEST_P(Group, InertiaWithoutMass) {
  Inertia<double> rotor;
  rotor.I.diagonal() << 1, 2, 3;
  const Placement X = placement();
  const Inertia<double> turned = rotor.transformed(X);
  EXPECT_EQ(turned.m, 0);
  EXPECT_EQ(size_of(turned.h), 0);
  EXPECT_LE(difference_of(turned.I, Mat3<double>(X.R * rotor.I * X.R.transpose())), kTight);
}

}  // namespace
}  // namespace manycontact::test
