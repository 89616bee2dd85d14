#pragma once
// Timer is a stopwatch that starts when it is constructed. The name is Crocoddyl's.

#include <chrono>

namespace manycontact {

class Timer {  // Measures the time since its start or its last reset.
 public:
  void reset() { start_ = Clock::now(); }                           // restarts the time at zero
  double get_duration() const { return get_us_duration() / 1000; }  // the time in ms
  /// Returns the time in microseconds.
  double get_us_duration() const { return std::chrono::duration<double, std::micro>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace manycontact
