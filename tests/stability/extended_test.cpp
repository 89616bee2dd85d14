// Solves every case in the precision `extended`. Solutions reported as extended have errors of a few units in the last
// place and true bounds; the others are the same as in double.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>

#include "manycontact/dynamics/solve.hpp"
#include "stability/condition.hpp"
#include "stability/judge.hpp"
#include "support/measure.hpp"

namespace manycontact::test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

const std::vector<Way>& extended_ways() {
  static const std::vector<Way> all = [] {
    std::vector<Way> out = {{"auto", {}},
                            {"sparse-ldl", {Method::kSparseLdl, {}}},
                            {"sparse-ldl robot by robot", {Method::kSparseLdl, {}, SimdLevel::kOff}},
                            {"sparse-bodies", {Method::kSparseBodies, {}}},
                            {"dense", {Method::kDense, {}}}};
    out.push_back(out.front());
    out.back().name = "auto, pairs not reduced";
    out.back().options.reduce_pairs = false;
    for (Way& way : out) way.options.precision = Precision::kExtended;
    return out;
  }();
  return all;
}

struct Sums {
  int answers = 0, extended = 0, refused = 0;
  double worst = 0, beyond = 0;
  std::vector<double> bound_over_error;
};

class Extended : public testing::TestWithParam<int> {};

TEST_P(Extended, AFewUnitsInTheLastPlace) {
  const Cases& cases = all_causes()[GetParam()];
  Sums up_to_12, up_to_15, beyond;
  for (const Case& which : cases.list) {
    if (which.bad_input) continue;
    const Problem p = which.make();
    const Truths truths(p);
    if (!truths.exists || p.only_known) continue;  // known solutions do not have the last digits of q
    for (const Way& way : extended_ways()) {
      if (!which.small && way.options.method == Method::kDense) continue;
      SCOPED_TRACE(which.name + " by " + way.name);
      SceneData data(p.scene, way.options);
      (void)solve(p.scene, p.q, p.v, p.u, data);
      if (data.report.status == Status::kFailed) continue;
      if (std::ranges::any_of(data.report.islands, [](const auto& i) { return i.reason == Reason::kDampingLost; }))
        continue;  // it solves another problem, which stability_test judges
      double cond = 0;
      bool extended = true;
      for (std::size_t i = 0; i < truths.islands.size(); ++i) {
        cond = std::max(cond, condition_of(truths, data.report, i));
        extended = extended && report_of(data.report, i).precision == Precision::kExtended;
      }
      Sums& sums = cond <= 1e12 ? up_to_12 : cond <= kTrueCondition ? up_to_15 : beyond;
      ++sums.answers;
      std::string note;
      for (const IslandReport& island : data.report.islands) {
        if (island.status < Status::kRegularised)
          EXPECT_EQ(island.reason == Reason::kLowPrecision, island.precision == Precision::kDouble);
        note += " [" + to_string(island.status) + " " + to_string(island.method) + "]";
      }
      if (!extended) {
        if (++sums.refused, std::getenv("MANYCONTACT_SHOW"))
          std::cout << "refused: " << cases.cause << ": " << which.name << " by " << way.name << note << ", condition "
                    << cond << ", contradiction " << truths.contradiction << "\n";
        continue;
      }
      const Cell cell = judge_answer(p, truths, data, way);
      ++sums.extended;
      const double error = worse(cell.error_a, cell.error_f);
      sums.worst = worse(sums.worst, error);
      sums.beyond = worse(sums.beyond, cell.beyond_bound);
      if (cond > kTrueCondition) continue;
      EXPECT_LE(cell.beyond_bound, 1) << "errors " << cell.error_a << " " << cell.error_f << " condition " << cond
                                      << note << " bounds " << data.report.error_acceleration << " "
                                      << data.report.error_forces;
      EXPECT_LE(error, 4 * kEps) << cell.error_a << " " << cell.error_f << ", condition " << cond << note;
    }
  }
  const auto show = [&](const char* name, const Sums& s) {
    std::cout << cases.cause << ", condition " << name << ": " << s.answers << " answers, " << s.extended
              << " extended, " << s.refused << " refused, worst error " << s.worst / kEps << " eps, error over bound "
              << s.beyond << "\n";
  };
  show("up to 1e12", up_to_12), show("up to 1e15", up_to_15), show("beyond", beyond);
}

std::vector<int> case_numbers() {
  std::vector<int> out(all_causes().size());
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = static_cast<int>(k);
  return out;
}

INSTANTIATE_TEST_SUITE_P(Causes, Extended, testing::ValuesIn(case_numbers()), [](const auto& info) {
  std::string name = all_causes()[info.param].cause;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

}  // namespace
}  // namespace manycontact::test
