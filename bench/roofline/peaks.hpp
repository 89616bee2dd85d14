#pragma once
// What this machine can do at most, on one core.

#include <string>

namespace manycontact::bench {

struct Peaks {
  std::string instructions;  // the widest vectors used
  double flops = 0;          // of fused multiply-adds of doubles, two operations each [1/s]; 0 without AVX2
  double memory = 0;         // of a triad over arrays that fit into no cache [bytes/s]
};
Peaks measure_peaks();

/// Processor time of this thread [s]: what the machine does meanwhile does not count, but for its use of the caches.
double processor_time();

}  // namespace manycontact::bench
