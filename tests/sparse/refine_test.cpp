// The refinement loop stops at the right step, and reports correctly.

#include "manycontact/sparse/refine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "manycontact/sparse/tolerances.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace manycontact::test {
namespace {

using sparse::refine;
using sparse::Refinement;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Contains errors given in advance, each read once.
struct Script {
  std::vector<double> errors;
  std::size_t read = 0;
  int corrections = 0;

  Refinement run(int max_steps, double small) {
    return refine(
        max_steps, small, [this] { return errors.at(read++); }, [this] { ++corrections; });
  }
};

TEST(Refine, StopsAtASmallError) {
  Script script{{1e-3, 1e-9, 1e-15, 0}};
  const Refinement out = script.run(5, 1e-15);  // equal is small enough
  EXPECT_EQ(out.steps, 2);
  EXPECT_EQ(script.corrections, 2);
  EXPECT_EQ(script.read, 3u) << "one residual per step, and one before";
  EXPECT_EQ(out.first, 1e-3);
  EXPECT_EQ(out.backward_error, 1e-15);
}

TEST(Refine, StopsWhereAStepDoesNotHalveTheError) {
  Script script{{1, 0.25, 0.125, 0.01}};  // half is not below half
  const Refinement out = script.run(5, 1e-15);
  EXPECT_EQ(out.steps, 2);
  EXPECT_EQ(script.corrections, 2) << "the last correction stays";
  EXPECT_EQ(out.backward_error, 0.125);
}

TEST(Refine, StopsAfterMaxSteps) {
  Script script{{1, 1e-1, 1e-2, 1e-3}};
  EXPECT_EQ(script.run(2, 1e-15).steps, 2);
  EXPECT_EQ(script.corrections, 2);
  Script none{{1}};
  EXPECT_EQ(none.run(0, 1e-15).steps, 0);
  EXPECT_EQ(none.corrections, 0);
}

TEST(Refine, DoesNothingWhereNothingIsLeft) {
  Script script{{0}};
  const Refinement out = script.run(5, 0);
  EXPECT_EQ(out.steps, 0);
  EXPECT_EQ(out.backward_error, 0);
}

TEST(Refine, NanStops) {
  Script at_once{{kNan}};
  EXPECT_EQ(at_once.run(5, 1e-15).steps, 0);
  Script later{{1, kNan}};
  const Refinement out = later.run(5, 1e-15);
  EXPECT_EQ(out.steps, 1);
  EXPECT_TRUE(std::isnan(out.backward_error));
  Script infinite{{kInf, kInf}};
  EXPECT_EQ(infinite.run(5, 1e-15).steps, 1);
}

// x = b / a in quadruple precision uses divisions that are off by a thousandth, on a panel of two numbers.
TEST(Refine, ServesWiderScalars) {
  const Quad a = 3, b[2] = {Quad(1), Quad(1e-30)};
  Quad x[2] = {0, 0}, r[2];
  const Refinement out = refine(
      60, 1e-33,
      [&] {
        double worst = 0;
        for (int k = 0; k < 2; ++k) {
          r[k] = b[k] - a * x[k];
          worst = std::max(worst, static_cast<double>(abs(r[k]) / b[k]));
        }
        return worst;
      },
      [&] {
        for (int k = 0; k < 2; ++k) x[k] += Quad(0.999 * static_cast<double>(r[k]) / 3);
      });
  EXPECT_EQ(out.first, 1);
  EXPECT_LE(out.backward_error, 1e-33) << "a double holds the sizes of quadruple errors";
  EXPECT_GT(out.steps, 8);
  for (int k = 0; k < 2; ++k) EXPECT_LE(static_cast<double>(abs(x[k] * a - b[k]) / b[k]), 1e-33);
}

TEST(ComponentwiseBackwardError, IsTheLargestRatio) {
  const std::vector<double> r = {1, -3, 0}, scale = {10, 5, 1};
  EXPECT_EQ(sparse::componentwise_backward_error(r, scale), 0.6);
  EXPECT_EQ(sparse::componentwise_backward_error({}, {}), 0);
  EXPECT_EQ(sparse::componentwise_backward_error(std::vector<double>{0, 0}, std::vector<double>{0, 0}), 0);
}

TEST(ComponentwiseBackwardError, RowsOfNoSizeCountAsEpsOfTheLargest) {
  const std::vector<double> scale = {8, 0, 1e-30};
  EXPECT_EQ(sparse::componentwise_backward_error(std::vector<double>{0, kEps, 0}, scale), 0.125);
  EXPECT_EQ(sparse::componentwise_backward_error(std::vector<double>{0, 0, 2 * kEps}, scale), 0.25);
}

TEST(ComponentwiseBackwardError, IsNanWhereAnythingIsNotFinite) {
  for (double bad : {kNan, kInf, -kInf})
    for (int row : {0, 1}) {
      std::vector<double> r = {1e-3, 1}, scale = {1, 1};
      r[row] = bad, scale[row] = std::abs(bad);
      EXPECT_TRUE(std::isnan(sparse::componentwise_backward_error(r, scale))) << bad << " in row " << row;
    }
  // sums that overflow, a residual that does not
  EXPECT_TRUE(
      std::isnan(sparse::componentwise_backward_error(std::vector<double>{1, 1}, std::vector<double>{kInf, 1})));
}

}  // namespace
}  // namespace manycontact::test
