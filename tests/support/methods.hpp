#pragma once
// Every way to solve a scene, for tests that must pass with all of them.

#include <string>
#include <vector>

#include "manycontact/dynamics/solve.hpp"

namespace manycontact::test {

inline std::vector<Method> methods() { return {std::begin(kMethods), std::end(kMethods)}; }

struct Way {
  std::string name;  // "sparse-ldl camd"
  Options options;
};

/// Returns each method with each order that it has, and sparse-ldl without SIMD; `dense` only on request.
inline std::vector<Way> ways(bool with_oracle = false) {
  std::vector<Way> out;
  for (Method method : methods()) {
    if (method == Method::kDense && !with_oracle) continue;
    out.push_back({to_string(method), {method, {}}});
    if (!has_order(method)) continue;
    for (Order order : kOrders) out.push_back({to_string(method) + " " + to_string(order), {method, order}});
  }
  out.push_back({"sparse-ldl robot by robot", {Method::kSparseLdl, {}, SimdLevel::kOff}});
  return out;
}

/// Returns these, and sparse-ldl at each instruction level of this machine.
inline std::vector<Way> ways_here(bool with_oracle = false) {
  std::vector<Way> out = ways(with_oracle);
  for (SimdLevel lanes : available_simd_levels())
    out.push_back({"sparse-ldl in lanes " + to_string(lanes), {Method::kSparseLdl, {}, lanes}});
  return out;
}

}  // namespace manycontact::test
