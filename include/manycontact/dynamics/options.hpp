#pragma once
#include <optional>
#include <string>

#include "manycontact/kkt/pattern.hpp"

namespace manycontact {

enum class Method {
  kDense,             // per island, rank-revealing: the oracle
  kDenseSchur,        // the whole scene as one system, LLT of M and of J M^-1 J^T, as Crocoddyl does: the baseline
  kSparseLdl,         // SuiteSparse LDL on K, per island
  kSparseCholmod,     // CHOLMOD's simplicial LDL' on K, per island
  kSparseSupernodal,  // tree-sparse factor of M, CHOLMOD's supernodal LL' on the Schur complement, per island
  kAuto,              // per island, the method and order of least predicted cost
};
inline constexpr Method kMethods[] = {Method::kDense,         Method::kDenseSchur,       Method::kSparseLdl,
                                      Method::kSparseCholmod, Method::kSparseSupernodal, Method::kAuto};
std::string to_string(Method method);
/// The method called `name`, as to_string writes it.
std::optional<Method> method_from_string(const std::string& name);
std::optional<Order> order_from_string(const std::string& name);

struct Options {
  Method method = Method::kAuto;
  std::optional<Order> order;  // of sparse-ldl and sparse-cholmod; none: the order of least predicted cost
  bool operator==(const Options&) const = default;
};

}  // namespace manycontact
