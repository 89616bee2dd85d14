#include "manycontact/sparse/largest.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace manycontact::test {
namespace {

TEST(LargerOrNan, KeepsNanWhereverItStands) {
  EXPECT_EQ(sparse::larger_or_nan(1.0, 2.0), 2);
  EXPECT_EQ(sparse::larger_or_nan(2.0, 1.0), 2);
  EXPECT_EQ(sparse::larger_or_nan(0.0, double(INFINITY)), INFINITY);
  const double nan = NAN;
  for (double x : {0.0, -1.0, double(INFINITY), nan}) {
    EXPECT_TRUE(std::isnan(sparse::larger_or_nan(nan, x)));
    EXPECT_TRUE(std::isnan(sparse::larger_or_nan(x, nan)));
  }
}

}  // namespace
}  // namespace manycontact::test
