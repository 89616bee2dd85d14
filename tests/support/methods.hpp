#pragma once
// Every way to solve a scene, for tests that must hold for all of them.

#include <string>
#include <vector>

#include "manycontact/dynamics/solve.hpp"
#include "manycontact/sparse/cholmod.hpp"

namespace manycontact::test {

/// Those of kMethods that this build has.
inline std::vector<Method> methods() {
  std::vector<Method> out;
  for (Method method : kMethods)
    if (method != Method::kSparseSupernodal || sparse::supernodal_available()) out.push_back(method);
  return out;
}

struct Way {
  std::string name;  // "sparse-ldl camd"
  Options options;
};

/// Each method, with each order where the method takes one, and sparse-ldl without lanes; the oracle only if asked
/// for.
inline std::vector<Way> ways(bool with_oracle = false) {
  std::vector<Way> out;
  for (Method method : methods()) {
    if (method == Method::kDense && !with_oracle) continue;
    out.push_back({to_string(method), {method, {}}});
    if (!has_order(method)) continue;
    for (Order order : kOrders) out.push_back({to_string(method) + " " + to_string(order), {method, order}});
  }
  out.push_back({"sparse-ldl robot by robot", {Method::kSparseLdl, {}, Lanes::kOff}});
  return out;
}

/// The same, and sparse-ldl at each level of instructions that runs here.
inline std::vector<Way> ways_here(bool with_oracle = false) {
  std::vector<Way> out = ways(with_oracle);
  for (Lanes lanes : lanes_here())
    out.push_back({"sparse-ldl in lanes " + to_string(lanes), {Method::kSparseLdl, {}, lanes}});
  return out;
}

}  // namespace manycontact::test
