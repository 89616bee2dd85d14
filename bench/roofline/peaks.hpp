#pragma once
// Peak rates of this machine on one core.

#include <string>

namespace manycontact::bench {

struct Peaks {
  std::string instructions;  // the widest vectors used
  double flops = 0;          // fused multiply-adds of doubles, two operations each [1/s]; 0 without AVX2
  double memory = 0;         // rate of a triad over arrays that fit into no cache [bytes/s]
};
Peaks measure_peaks();

/// Returns processor time of this thread [s]: other work of the machine affects it only through the caches.
double processor_time();

}  // namespace manycontact::bench
