#pragma once
// Options of a solve: methods, elimination orders, SIMD instructions and threads.

#include <optional>
#include <string>

namespace manycontact {

/// Methods for an island's system.
enum class Method {
  kDense,           // rank-revealing, per island: the dense reference solver
  kDenseSchur,      // the whole scene as one system, LLT of M and of J M^-1 J^T, as in Crocoddyl: the baseline
  kSparseLdl,       // LDL^T of K by a compiled schedule, per island
  kSuiteSparseLdl,  // LDL^T of K by SuiteSparse's LDL, for comparison; kAuto never chooses it
  kSparseCholmod,   // CHOLMOD's simplicial LDL^T of K, per island
  kSparseBodies,    // accelerations of bodies and forces of joints are kept as unknowns, per island: linear in the
                    // depth of trees
  kAuto,            // the sparse method and order of least predicted cost, per island
};
inline constexpr Method kMethods[] = {
    Method::kDense,         Method::kDenseSchur,   Method::kSparseLdl, Method::kSuiteSparseLdl,
    Method::kSparseCholmod, Method::kSparseBodies, Method::kAuto};
std::string to_string(Method method);  // "sparse-ldl"
/// The method with the given name, as to_string writes it; none if there is no such method.
std::optional<Method> method_from_string(const std::string& name);
/// Whether a method eliminates the rows of K in an order that can be chosen.
constexpr bool has_order(Method m) {
  return m == Method::kSparseLdl || m == Method::kSuiteSparseLdl || m == Method::kSparseCholmod;
}

/// The place of the constraint rows in the elimination order. Joints are eliminated leaves first: M has no fill-in.
enum class Order {
  kLeafToRoot,     // contacts last; accurate whenever J has full rank
  kContactsEarly,  // a contact as soon as the joints that move it in all its directions are eliminated; less fill-in
  kCamd,           // SuiteSparse's CAMD, all joints before all contacts
};
inline constexpr Order kOrders[] = {Order::kLeafToRoot, Order::kContactsEarly, Order::kCamd};
std::string to_string(Order order);                               // "leaf-to-root"
std::optional<Order> order_from_string(const std::string& name);  // the order with that name, or none

/// How an island is solved. The method is never kAuto. K is assembled in the given order, and eliminated in that order
/// if the method has one.
struct Choice {
  Method method = Method::kSparseLdl;
  Order order = Order::kLeafToRoot;
};

/// The SIMD instructions with which several robots are solved at a time: 2 (baseline), 4 (AVX2 and FMA) or 8 (AVX-512).
///
/// The robots of a batch have the same kinematic structure. Islands of one robot are batched as a whole by sparse-ldl.
/// Islands of several robots are batched robot by robot by sparse-ldl, if this is cheaper. With sparse-bodies, the
/// subtrees between constrained bodies are batched. A level that is not compiled in, or not supported by the processor,
/// is treated as kOff.
enum class SimdLevel {
  kAuto,  // the widest level that this processor supports
  kOff,   // no batches: one robot or subtree at a time
  kBaseline,
  kAvx2,
  kAvx512,
};
inline constexpr SimdLevel kSimdLevels[] = {SimdLevel::kAuto, SimdLevel::kOff, SimdLevel::kBaseline, SimdLevel::kAvx2,
                                            SimdLevel::kAvx512};
std::string to_string(SimdLevel lanes);  // "auto", "off", "baseline", "avx2", "avx512"
std::optional<SimdLevel> simd_level_from_string(const std::string& name);  // the level with that name, or none

/// The arithmetic of a solve: of the terms of K and of the right-hand side, of its factor, and of the residuals of
/// iterative refinement. Derivatives and products at the solution are always computed in double.
enum class Precision {
  kSingle,    // float, float, float, not refined: errors of about 1e-7 times the condition of K
  kDouble,    // double throughout
  kExtended,  // double-double, double, double-double: up to a condition of 1e15, errors of a and f of at most
              // 4 eps of their largest entries; derivatives and products are those of kDouble at this solution
};
inline constexpr Precision kPrecisions[] = {Precision::kSingle, Precision::kDouble, Precision::kExtended};
std::string to_string(Precision precision);  // "single", "double", "extended"
/// The precision with the given name, as to_string writes it; none if there is no such precision.
std::optional<Precision> precision_from_string(const std::string& name);

inline constexpr int kMostThreads = 4096;  // larger numbers of threads are refused

struct Options {  // How to solve.
  Method method = Method::kAuto;
  std::optional<Order> order;  // used by methods with has_order; none: the order of least predicted cost
  SimdLevel simd_level = SimdLevel::kAuto;
  /// Threads of OpenMP inside a call of solve, differentiate, jvp and vjp, kMostThreads at most. They work on islands,
  /// on SIMD batches, and on the robots of a large island. 0 takes as many as OpenMP offers.
  ///
  /// Results do not depend on the number of threads.
  int threads = 1;
  /// Whether the constraint rows of several contacts between the same two bodies are reduced to at most six independent
  /// rows before the factorization. All methods do so except kDense and kDenseSchur, if Scene::tolerance is zero and
  /// the contacts are expressed in A's axes. If false, dependent rows are found in K instead.
  bool reduce_pairs = true;
  /// Islands that cannot be solved in this precision are solved in kDouble. IslandReport::precision shows which was
  /// used, and IslandReport::reason is kLowPrecision unless the island has another reason.
  ///
  /// kSingle requires islands of one robot that sparse-ldl solves in SIMD batches, without dependent rows and without
  /// two contacts between the same bodies. It is refused if rounding errors may change the largest acceleration or
  /// force by more than 1 %. Derivatives, products and error bounds are computed in double at the solution; those of
  /// kSingle are therefore as accurate as its accelerations and forces.
  Precision precision = Precision::kDouble;
  bool operator==(const Options&) const = default;
};

}  // namespace manycontact
