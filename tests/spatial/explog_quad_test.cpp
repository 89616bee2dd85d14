// True errors of exponentials and logarithms are found in quadruple precision, their Jacobians from differences.

#include <gtest/gtest.h>

#include <numbers>

#include "manycontact/spatial/explog.hpp"
#include "spatial/compare.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kQuadAngles[] = {0,        1e-12, 1e-10, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3 - 1e-9,      1e-3 + 1e-9,
                                  0.01,     0.1,   0.49,  0.51, 1,    2,    3,    kHalfTurn - 1e-3, kHalfTurn - 1e-8,
                                  kHalfTurn};
constexpr int kQuadTrials = 10;

Vec6<double> turning_by(double angle, std::mt19937& rng) {
  Vec6<double> m;
  m << random_vector(3, rng), angle * random_vector(3, rng).normalized();
  return m;
}

Vec6<Quad> quad(const Vec6<double>& m) { return m.cast<Quad>(); }

TEST(ExpLogInQuad, RoundTripIsGoodToQuad) {
  std::mt19937 rng(1);
  for (double angle : kQuadAngles) {
    const Vec6<Quad> m = quad(turning_by(angle, rng));
    EXPECT_LE(error_of(log6<Quad>(exp6<Quad>(m)), m), 1e-30) << angle;  // double's pi is below the true one
  }
}

TEST(ExpLogInQuad, ExpOfDouble) {
  std::mt19937 rng(2);
  for (double angle : kQuadAngles)
    for (int trial = 0; trial < kQuadTrials; ++trial) {
      const Vec6<double> m = turning_by(angle, rng);
      const SE3<double> M = exp6<double>(m);
      const SE3<Quad> truth = exp6<Quad>(quad(m));
      EXPECT_LE(difference_of(M.R, truth.R), 8 * kEps) << angle;
      EXPECT_LE(error_of(M.p, truth.p), 16 * kEps) << angle;
      EXPECT_LE(difference_of(exp3<double>(m.tail<3>()), truth.R), 8 * kEps) << angle;
    }
}

// The argument is a rotation up to rounding, which changes log by as much; near pi either sign is right.
TEST(ExpLogInQuad, LogOfDouble) {
  std::mt19937 rng(3);
  for (double angle : kQuadAngles)
    for (int trial = 0; trial < kQuadTrials; ++trial) {
      const SE3<double> M = exp6<double>(turning_by(angle, rng));
      const Vec6<double> m = log6<double>(M);
      const Vec6<Quad> truth = log6<Quad>(M.cast<Quad>());
      if (angle == kHalfTurn && m.tail<3>().dot(truth.tail<3>().cast<double>()) < 0) continue;
      EXPECT_LE(difference_of(m.tail<3>(), truth.tail<3>()), 8 * kEps * std::max(angle, 1e-30)) << angle;
      EXPECT_LE(error_of(m, truth), 16 * kEps) << angle;
    }
}

TEST(ExpLogInQuad, JacobiansOfDouble) {
  std::mt19937 rng(4);
  for (double angle : kQuadAngles)
    for (int trial = 0; trial < kQuadTrials; ++trial) {
      const Vec6<double> m = turning_by(angle, rng);
      EXPECT_LE(error_of(Jlog6<double>(m), Jlog6<Quad>(quad(m))), 32 * kEps) << angle;
      EXPECT_LE(error_of(Jexp6<double>(m), Jexp6<Quad>(quad(m))), 32 * kEps) << angle;
    }
}

// Columns are log6(M exp6(h e_k)) and log6(exp6(-m) exp6(m + h e_k)). Differences in Quad are accurate to 1e-18.
TEST(ExpLogInQuad, JacobiansAgainstCentralDifferences) {
  std::mt19937 rng(5);
  const Quad h(1e-10);
  for (double angle : {0.0, 1e-8, 1e-4, 0.01, 0.49, 0.51, 1.0, 2.5, kHalfTurn - 1e-3, kHalfTurn - 1e-6}) {
    const Vec6<Quad> m = quad(turning_by(angle, rng));
    const SE3<Quad> M = exp6<Quad>(m), inverse = M.inverse();
    Mat6<Quad> Jlog, Jexp;
    for (int k = 0; k < 6; ++k) {
      const Vec6<Quad> d = h * Vec6<Quad>::Unit(k);
      Jlog.col(k) = (log6<Quad>(M * exp6<Quad>(d)) - log6<Quad>(M * exp6<Quad>(Vec6<Quad>(-d)))) / (Quad(2) * h);
      Jexp.col(k) =
          (log6<Quad>(inverse * exp6<Quad>(Vec6<Quad>(m + d))) - log6<Quad>(inverse * exp6<Quad>(Vec6<Quad>(m - d)))) /
          (Quad(2) * h);
    }
    EXPECT_LE(error_of(Jlog6<Quad>(m), Jlog), 1e-18) << angle;
    EXPECT_LE(error_of(Jexp6<Quad>(m), Jexp), 1e-18) << angle;
    EXPECT_LE(error_of(Jlog6<double>(m.cast<double>()), Jlog), 32 * kEps) << angle;
  }
}

TEST(ExpLogInQuad, Se2OfDouble) {
  std::mt19937 rng(6);
  for (double angle : kQuadAngles)
    for (int trial = 0; trial < kQuadTrials; ++trial) {
      const Vec3<double> m(uniform(rng, -1, 1), uniform(rng, -1, 1), angle);
      const Vec3<double> d = exp_se2<double>(m);
      EXPECT_LE(error_of(d, exp_se2<Quad>(m.cast<Quad>())), 8 * kEps) << angle;
      EXPECT_LE(error_of(log_se2<double>(d), log_se2<Quad>(d.cast<Quad>())), 16 * kEps) << angle;
    }
}

TEST(ExpLogInQuad, QuaternionOfRotationOfDouble) {
  std::mt19937 rng(7);
  for (int trial = 0; trial < 100; ++trial) {
    const Mat3<double> R = random_rotation(rng);
    EXPECT_LE(difference_of(quaternion_of_rotation<double>(R), quaternion_of_rotation<Quad>(R.cast<Quad>())), 8 * kEps);
  }
}

}  // namespace
}  // namespace manycontact::test
