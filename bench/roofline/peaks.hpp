#pragma once
// What this machine can do at most, on one core.

#include <string>

namespace manycontact::bench {

struct Peaks {
  std::string instructions;  // the widest vectors used
  double flops = 0;          // of fused multiply-adds of doubles, two operations each [1/s]
  double memory = 0;         // of a triad over arrays that fit into no cache [bytes/s]
};
Peaks measure_peaks();

}  // namespace manycontact::bench
