#pragma once

#include <chrono>
#include <string>

namespace manycontact::cli {

class Progress {
 public:
  /// Shows progress in one line of standard error, if that is a terminal or if `always`.
  Progress(std::string label, double total, bool always = false);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows `done` of `total`, at most four times a second, and not in the first quarter of a second.
  void update(double done);
  void update(double done, const std::string& label);
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  double total_;
  bool shown_, drawn_ = false;
  Clock::time_point start_, last_;
};

}  // namespace manycontact::cli
