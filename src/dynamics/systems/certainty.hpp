#pragma once
// Whether anything is known of an answer, by its bounds.

#include <algorithm>

#include "manycontact/dynamics/report.hpp"

namespace manycontact::internal {

/// The largest entry of an answer, and of what acts: the size that it would have if nothing cancelled.
struct AnswerSize {
  double own = 0, acting = 0;
};

/// Where a bound says nothing, and more is unknown than rounding of what acts, as an answer at rest is: that is the
/// answer to a neighbouring problem, not to the one asked.
inline void judge_bounds(const AnswerSize& a, const AnswerSize& f, IslandReport& report) {
  constexpr double kNegligible = 1e-6;
  const auto unknown = [](double bound, const AnswerSize& x) {
    return bound >= 1 && bound * x.own > kNegligible * x.acting;
  };
  if (report.status > Status::kRedundant) return;
  if (!unknown(report.error_acceleration, a) && !unknown(report.error_forces, f)) return;
  report.status = Status::kRegularised;
  report.reason = Reason::kUncertain;
}

}  // namespace manycontact::internal
