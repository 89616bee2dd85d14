// Every case of the table in single and mixed precision: what is called a solution in that precision has its digits,
// and all else is told.

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "manycontact/dynamics/solve.hpp"
#include "stability/judge.hpp"

namespace manycontact::test {
namespace {

struct Count {
  int cases = 0, in_precision = 0, worst_is_known = 0;
  double worst = 0;
};

void judge_in(Precision precision, const Case& which, Count& count) {
  Problem p;
  try {
    p = which.make();
  } catch (const std::invalid_argument&) {
    return;
  }
  Way way{to_string(precision), {}};
  way.options.precision = precision;
  SceneData data(p.scene, way.options);
  (void)solve(p.scene, p.q, p.v, p.u, data);
  const auto& islands = data.report.islands;
  ++count.cases;
  if (std::none_of(islands.begin(), islands.end(), [=](const auto& i) { return i.precision == precision; })) return;
  ++count.in_precision;
  const Truths truths(p);
  const Cell cell = judge_answer(p, truths, data, way);
  ASSERT_TRUE(truths.exists) << which.name << ": " << cell.note;
  if (precision == Precision::kMixed) {
    EXPECT_NE(cell.outcome, Outcome::kWrong) << which.name << ": " << cell.note;
    return;
  }
  count.worst = std::max({count.worst, cell.error_a, cell.error_f});
  EXPECT_LE(cell.error_a, 1e-2) << which.name << ": " << cell.note;
  EXPECT_LE(cell.error_f, 1e-2) << which.name << ": " << cell.note;
  EXPECT_LE(cell.beyond_bound, 1) << which.name << ": " << cell.note;
}

class Precisions : public testing::TestWithParam<Precision> {};

TEST_P(Precisions, NothingIsWrongInSilence) {
  Count count;
  for (const Cases& cause : all_causes())
    for (const Case& which : cause.list)
      if (which.small) judge_in(GetParam(), which, count);
  std::cout << to_string(GetParam()) << ": " << count.in_precision << " of " << count.cases
            << " cases have an island in this precision; largest error " << count.worst << "\n";
}

INSTANTIATE_TEST_SUITE_P(Of, Precisions, testing::Values(Precision::kSingle, Precision::kMixed),
                         [](const auto& info) { return to_string(info.param); });

}  // namespace
}  // namespace manycontact::test
