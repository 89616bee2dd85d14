// Exponentials and logarithms in double: round trips at every angle, quaternions, SE(2). explog_quad_test: true errors.

#include "manycontact/spatial/explog.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "spatial/compare.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kAngles[] = {0, 1e-10, 1e-5, 1e-3, 0.5 - 1e-9, 0.5 + 1e-9, 1, 3, kPi - 1e-3, kPi - 1e-8, kPi};

Vec3<double> random_axis(std::mt19937& rng) { return random_vector(3, rng).normalized(); }

Vec6<double> motion_of_angle(double angle, std::mt19937& rng) {
  Vec6<double> m;
  m << random_vector(3, rng), angle * random_axis(rng);
  return m;
}

TEST(ExpLog, RoundTripOnSO3) {
  std::mt19937 rng(1);
  for (double angle : kAngles)
    for (int trial = 0; trial < 20; ++trial) {
      const Vec3<double> w = angle * random_axis(rng);
      const Mat3<double> R = exp3<double>(w);
      const Vec3<double> back = log3<double>(R);
      EXPECT_LE(difference_of(Mat3<double>(R * R.transpose()), Mat3<double>::Identity().eval()), 16 * kEps) << angle;
      EXPECT_NEAR(R.determinant(), 1, 16 * kEps);
      EXPECT_LE(difference_of(exp3<double>(back), R), 16 * kEps) << angle;
      double error = difference_of(back, w);
      if (angle == kPi) error = std::min(error, difference_of(Vec3<double>(-back), w));  // either sign is right
      EXPECT_LE(error, angle < 1e-4 ? 4 * kEps * angle : 16 * kEps) << angle;
    }
}

TEST(ExpLog, RoundTripOnSE3) {
  std::mt19937 rng(2);
  for (double angle : kAngles)
    for (int trial = 0; trial < 20; ++trial) {
      const Vec6<double> m = motion_of_angle(angle, rng);
      const SE3<double> M = exp6<double>(m);
      const Vec6<double> back = log6<double>(M);
      EXPECT_LE(difference_of(exp6<double>(back), M), 64 * kEps) << angle;
      if (angle < kPi) {
        EXPECT_LE(error_of(back, m), 64 * kEps) << angle;
      }
    }
}

TEST(ExpLog, PureTranslationIsExact) {
  Vec6<double> m;
  m << 1.5, -2, 1e5, 0, 0, 0;
  EXPECT_EQ(exp6<double>(m).p, (Vec3<double>(1.5, -2, 1e5)));
  EXPECT_EQ(log6<double>(exp6<double>(m)), m);
}

// Pitch along the axis stays; with a rotation about z by a, a unit speed along x draws an arc of radius 1/a.
TEST(ExpLog, ScrewAboutZ) {
  for (double a : {1e-9, 1e-3, 0.4, 0.6, 2.0, 3.1}) {
    Vec6<double> m;
    m << 1, 0, 0.7, 0, 0, a;
    const SE3<double> M = exp6<double>(m);
    const double half = std::sin(a / 2);
    EXPECT_LE(difference_of(M.p, Vec3<double>(std::sin(a) / a, 2 * half * half / a, 0.7)), 8 * kEps);
    EXPECT_LE(difference_of(M.R, rotation_about<double>(Vec3<double>::UnitZ(), a)), 8 * kEps);
  }
}

// Jlog6's coefficients cancel as 1/t^2 somewhat above the switch from the series: tens of eps.
TEST(ExpLog, RightJacobiansAreInverse) {
  std::mt19937 rng(3);
  for (double angle : {0.0, 1e-10, 1e-5, 1e-3, 0.1, 0.5 - 1e-9, 0.5 + 1e-9, 1.0, 3.0, kPi - 1e-3, kPi - 1e-8, kPi})
    for (int trial = 0; trial < 20; ++trial) {
      const Vec6<double> m = motion_of_angle(angle, rng);
      EXPECT_LE(difference_of(Mat6<double>(Jexp6<double>(m) * Jlog6<double>(m)), Mat6<double>::Identity().eval()),
                128 * kEps)
          << angle;
    }
}

TEST(ExpLog, JacobiansAtZeroAndAlongTheMotion) {
  std::mt19937 rng(4);
  const Vec6<double> zero = Vec6<double>::Zero();
  EXPECT_EQ(Jlog6<double>(zero), Mat6<double>::Identity());
  EXPECT_EQ(Jexp6<double>(zero), Mat6<double>::Identity());
  for (double angle : {1e-3, 1.0, 3.0}) {  // exp6((1 + e) m) = exp6(m) exp6(e m)
    const Vec6<double> m = motion_of_angle(angle, rng);
    EXPECT_LE(error_of(Vec6<double>(Jlog6<double>(m) * m), m), 16 * kEps);
    EXPECT_LE(error_of(Vec6<double>(Jexp6<double>(m) * m), m), 16 * kEps);
  }
}

TEST(ExpLog, Se2IsThePlanePartOfSe3) {
  std::mt19937 rng(5);
  for (double angle : {0.0, 1e-10, -1e-5, 1e-3, -0.3, 0.6, 1.0, -3.0, kPi - 1e-8, kPi}) {
    const Vec3<double> m(uniform(rng, -1, 1), uniform(rng, -1, 1), angle);
    Vec6<double> m6;
    m6 << m[0], m[1], 0, 0, 0, angle;
    const Vec3<double> d = exp_se2<double>(m);
    EXPECT_LE(difference_of(d.head<2>(), exp6<double>(m6).p.head<2>()), 8 * kEps) << angle;
    EXPECT_EQ(d[2], angle);
    EXPECT_LE(difference_of(log_se2<double>(d), m), 16 * kEps) << angle;
  }
  const Vec3<double> beyond(0.3, 0.4, 5);  // log_se2 accepts any angle, beyond pi too
  EXPECT_LE(difference_of(log_se2<double>(exp_se2<double>(beyond)), beyond), 32 * kEps);
}

// ---- quaternions ----------------------------------------------------------------------------------------------------

using Quaternion = Eigen::Vector4d;

void expect_quaternion_survives(const Quaternion& q) {
  const Quaternion back = quaternion_of_rotation<double>(rotation_of_quaternion<double>(q[0], q[1], q[2], q[3]));
  EXPECT_LE(std::min(difference_of(back, q), difference_of(back, Quaternion(-q))), 8 * kEps) << q.transpose();
  EXPECT_GE(back[3], 0);
  EXPECT_NEAR(back.norm(), 1, 4 * kEps);
}

// The largest component decides the branch.
TEST(Quaternion, OfRotationInAllFourBranches) {
  std::mt19937 rng(6);
  for (int largest = 0; largest < 4; ++largest)
    for (int trial = 0; trial < 20; ++trial) {
      Quaternion q = random_vector(4, rng, 0.2);
      q[largest] = trial % 2 ? -1 : 1;
      expect_quaternion_survives(q.normalized());
      expect_quaternion_survives(Quaternion::Unit(largest));
    }
  expect_quaternion_survives({0.5, 0.5, 0.5, 0.5});  // all equal
  expect_quaternion_survives({0.5, -0.5, 0.5, -0.5});
}

TEST(Quaternion, RotationIsOrthonormalAlsoWhenTheLengthIsOff) {
  std::mt19937 rng(7);
  for (double length : {0.999, 1.0, 1.001}) {
    const Quaternion q = random_vector(4, rng).normalized() * length;
    const Mat3<double> R = rotation_of_quaternion<double>(q[0], q[1], q[2], q[3]);
    EXPECT_LE(difference_of(Mat3<double>(R * R.transpose()), Mat3<double>::Identity().eval()), 8 * kEps);
    EXPECT_NEAR(R.determinant(), 1, 8 * kEps);
  }
}

TEST(Quaternion, IsHalfTheAngleAboutTheAxis) {
  std::mt19937 rng(8);
  for (double angle : {1e-9, 0.3, 2.0, 3.1}) {
    const Vec3<double> axis = random_axis(rng);
    const Vec3<double> u = std::sin(angle / 2) * axis;
    const Mat3<double> R = rotation_of_quaternion<double>(u[0], u[1], u[2], std::cos(angle / 2));
    EXPECT_LE(difference_of(R, rotation_about<double>(axis, angle)), 8 * kEps);
    EXPECT_LE(difference_of(R, exp3<double>(angle * axis)), 8 * kEps);
    EXPECT_LE(difference_of(Vec3<double>(R * axis), axis), 8 * kEps);
  }
}

}  // namespace
}  // namespace manycontact::test
