#include "progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace manycontact::cli {

Progress::Progress(std::string label, double total, bool always)
    : label_(std::move(label)),
      total_(total),
      shown_(always || isatty(STDERR_FILENO)),
      start_(Clock::now()),
      last_(start_) {}

void Progress::update(double done, const std::string& label) {
  if (shown_) label_ = label;
  update(done);
}

void Progress::update(double done) {
  if (!shown_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_ < std::chrono::milliseconds(250)) return;
  last_ = now;
  constexpr int kWidth = 30;
  const double part = std::clamp(done / total_, 0.0, 1.0);
  const double spent = std::chrono::duration<double>(now - start_).count();
  const int filled = static_cast<int>(part * kWidth);
  std::fprintf(stderr, "\r[%.*s%.*s] %3.0f%%  %.0f s left  %s\033[K", filled,
               "==============================", kWidth - filled, "                              ", 100 * part,
               part > 0 ? spent * (1 - part) / part : 0.0, label_.c_str());
  std::fflush(stderr);
  drawn_ = true;
}

void Progress::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

}  // namespace manycontact::cli
