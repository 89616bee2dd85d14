#pragma once
#include <chrono>

#include "manycontact/dynamics/report.hpp"

namespace manycontact::internal {

/// Measures a solve for its report: it starts when it is constructed; call `prepared` when the islands are set up.
class SolveClock {
 public:
  void prepared() { prepared_ = Clock::now(); }
  const Report& report(Report& report) const {
    report.times = {us(prepared_ - start_), us(Clock::now() - prepared_)};
    return report;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double us(Clock::duration d) { return std::chrono::duration<double, std::micro>(d).count(); }
  Clock::time_point start_ = Clock::now(), prepared_ = start_;
};

}  // namespace manycontact::internal
