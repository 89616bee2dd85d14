#pragma once
// Ways of solving an island's system: methods and orders of elimination.

#include <optional>
#include <string>

namespace manycontact {

enum class Method {
  kDense,             // per island, rank-revealing: the oracle
  kDenseSchur,        // the whole scene as one island, LLT of M and of J M^-1 J^T, as Crocoddyl does: the baseline
  kSparseLdl,         // LDL' of K by a compiled schedule (sparse/ldl_schedule.hpp), per island
  kSuiteSparseLdl,    // the same by SuiteSparse's LDL: a second opinion, never taken by kAuto
  kSparseCholmod,     // CHOLMOD's simplicial LDL' on K, per island
  kSparseSupernodal,  // tree-sparse factor of M, CHOLMOD's supernodal LL' on the Schur complement, per island
  kSparseBodies,      // bodies' accelerations and joints' forces kept as unknowns, per island: linear in deep trees
  kAuto,              // per island, the sparse method and order of least predicted cost
};
inline constexpr Method kMethods[] = {Method::kDense,          Method::kDenseSchur,    Method::kSparseLdl,
                                      Method::kSuiteSparseLdl, Method::kSparseCholmod, Method::kSparseSupernodal,
                                      Method::kSparseBodies,   Method::kAuto};
std::string to_string(Method method);  // "sparse-ldl"
/// The method called `name`, as to_string writes it.
std::optional<Method> method_from_string(const std::string& name);
/// Whether a method eliminates K's rows in an order that can be chosen.
constexpr bool has_order(Method m) {
  return m == Method::kSparseLdl || m == Method::kSuiteSparseLdl || m == Method::kSparseCholmod;
}

/// Where the contact rows go among the joints. Joints go from the leaves to the root, which fills nothing in M.
enum class Order {
  kLeafToRoot,     // contacts last: sound whenever J has full rank
  kContactsEarly,  // a contact as soon as joints that move it in all its directions are eliminated; less fill
  kCamd,           // SuiteSparse CAMD, all joints before all contacts
};
inline constexpr Order kOrders[] = {Order::kLeafToRoot, Order::kContactsEarly, Order::kCamd};
std::string to_string(Order order);                               // "leaf-to-root"
std::optional<Order> order_from_string(const std::string& name);  // likewise

/// How an island is solved. method: not kAuto. order: of the pattern that K is assembled in, eliminated in that order
/// where the method has one.
struct Choice {
  Method method = Method::kSparseLdl;
  Order order = Order::kLeafToRoot;
};

/// Instructions for robots side by side in SIMD lanes, 2 (baseline), 4 (AVX2 and FMA) or 8 (AVX-512) of one model at a
/// time: islands of one robot by sparse-ldl as a whole, islands of several robots by sparse-ldl robot by robot where
/// that is cheaper (derivatives by sparse-supernodal too), and by sparse-bodies the subtrees into which held bodies cut
/// a tree. A level that is not compiled in, or does not run here, is as kOff.
enum class Lanes {
  kAuto,  // the widest that runs here
  kOff,   // robot by robot, subtree by subtree
  kBaseline,
  kAvx2,
  kAvx512,
};
inline constexpr Lanes kLanes[] = {Lanes::kAuto, Lanes::kOff, Lanes::kBaseline, Lanes::kAvx2, Lanes::kAvx512};
std::string to_string(Lanes lanes);                               // "auto", "off", "baseline", "avx2", "avx512"
std::optional<Lanes> lanes_from_string(const std::string& name);  // likewise

inline constexpr int kMostThreads = 4096;  // more are a misprint, rather than a machine

struct Options {  // How to solve.
  Method method = Method::kAuto;
  std::optional<Order> order;  // of methods with has_order; none: the order of least predicted cost
  Lanes lanes = Lanes::kAuto;
  /// Threads of OpenMP inside a call of solve, differentiate, jvp and vjp: over islands, robots side by side, and
  /// robots of a large island; kMostThreads at most. 0: as many as OpenMP would take. Results do not depend on it (of
  /// sparse-supernodal: where the BLAS works in one thread). Above 1, OpenBLAS is held to one thread meanwhile, in the
  /// whole program: one such call at a time.
  int threads = 1;
  /// Rows of several contacts between the same two bodies are reduced to those that span them, six at most, before
  /// anything is factorized: by all methods but kDense and kDenseSchur, where Scene::tolerance is zero, of contacts in
  /// A's axes. false: rows that depend on each other are found in K instead, and `complete` shows every contact.
  bool reduce_pairs = true;
  bool operator==(const Options&) const = default;
};

}  // namespace manycontact
