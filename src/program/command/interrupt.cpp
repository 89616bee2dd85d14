#include "interrupt.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <cstring>

namespace manycontact::cli {

namespace {

// Data of the signal handler. It may access only these, because they are in static memory and have atomic flags.
constexpr int kMostFiles = 64;
std::array<std::array<char, PATH_MAX>, kMostFiles> names;
std::array<std::atomic<bool>, kMostFiles> removed_by_signals{};
std::atomic<int> listening{0};
std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void handle(int signal) {
  if (listening > 0 && !interrupted.exchange(true)) return;
  for (int k = 0; k < kMostFiles; ++k)
    if (removed_by_signals[k]) unlink(names[k].data());
  std::signal(signal, SIG_DFL);
  (void)raise(signal);
}

}  // namespace

void hear_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before = {};
    if (sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) continue;
    struct sigaction action = {};
    action.sa_handler = handle;
    sigaction(signal, &action, nullptr);
  }
}

InterruptFlag::InterruptFlag() {
  interrupted = false;
  ++listening;
}
InterruptFlag::~InterruptFlag() { --listening; }
bool InterruptFlag::is_set() const { return interrupted; }

RemovedBySignals::RemovedBySignals(const std::string& path) : slot_(-1) {
  if (path.size() >= PATH_MAX) return;
  static std::array<std::atomic<bool>, kMostFiles> taken{};
  for (int k = 0; k < kMostFiles && slot_ < 0; ++k)
    if (bool free = false; !removed_by_signals[k] && taken[k].compare_exchange_strong(free, true)) {
      std::memcpy(names[k].data(), path.c_str(), path.size() + 1);
      removed_by_signals[k] = true;
      taken[k] = false;
      slot_ = k;
    }
}
RemovedBySignals::~RemovedBySignals() {
  if (slot_ >= 0) removed_by_signals[slot_] = false;
}

}  // namespace manycontact::cli
