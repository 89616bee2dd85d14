#pragma once
// A stopwatch, running from its construction on. Crocoddyl's Timer.

#include <chrono>

namespace manycontact {

class Timer {  // seconds since its start
 public:
  void reset() { start_ = Clock::now(); }
  double get_duration() const { return get_us_duration() / 1000; }  // ms
  double get_us_duration() const { return std::chrono::duration<double, std::micro>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace manycontact
