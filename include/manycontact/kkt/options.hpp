#pragma once
// Options of a solve: method, elimination order, precision, SIMD instructions and threads.

#include <optional>
#include <string>

namespace manycontact {

/// Methods that solve the KKT system of an island (a set of robots coupled by contacts or springs).
enum class Method {
  kDense,           // rank-revealing dense factor, per island: the dense reference solver
  kDenseSchur,      // LLT of M and J M^-1 J^T of the whole scene, as in Crocoddyl: the baseline of comparisons
  kSparseLdl,       // LDL^T of K by a precompiled schedule, per island
  kSuiteSparseLdl,  // LDL^T of K by SuiteSparse's LDL, for comparison; kAuto never chooses it
  kSparseCholmod,   // CHOLMOD's simplicial LDL^T of K, per island
  kSparseBodies,    // sparse factor, per island, of a system with accelerations of bodies and forces of joints as
                    // further unknowns; cost linear in the depth of trees
  kAuto,            // the sparse method and elimination order of least predicted cost, per island
};
inline constexpr Method kMethods[] = {
    Method::kDense,         Method::kDenseSchur,   Method::kSparseLdl, Method::kSuiteSparseLdl,
    Method::kSparseCholmod, Method::kSparseBodies, Method::kAuto};
std::string to_string(Method method);  // "sparse-ldl"
/// Returns the method to which to_string gives this name; nullopt if there is none.
std::optional<Method> method_from_string(const std::string& name);
/// Returns whether a method eliminates the rows of K in an order that can be chosen.
constexpr bool has_order(Method m) {
  return m == Method::kSparseLdl || m == Method::kSuiteSparseLdl || m == Method::kSparseCholmod;
}

/// The position of contact rows in the elimination order of K. Joints are eliminated from the leaves to the root, so
/// that M has no fill-in.
enum class Order {
  kLeafToRoot,     // all contacts last; accurate if J has full rank
  kContactsEarly,  // each contact once joints that move it in all its directions are eliminated; less fill-in
  kCamd,           // the order of SuiteSparse's CAMD, with all joints before all contacts
};
inline constexpr Order kOrders[] = {Order::kLeafToRoot, Order::kContactsEarly, Order::kCamd};
std::string to_string(Order order);                               // "leaf-to-root"
std::optional<Order> order_from_string(const std::string& name);  // the order with that name, or none

/// The method and order with which an island is solved; the method is never kAuto. K is assembled in `order`, and
/// methods with has_order eliminate in this order.
struct Choice {
  Method method = Method::kSparseLdl;
  Order order = Order::kLeafToRoot;
};

/// SIMD instructions with which a solve computes several robots at a time: 2 (baseline), 4 (AVX2 and FMA) or 8
/// (AVX-512) robots.
///
/// The robots of a batch have the same kinematic structure. With sparse-ldl, islands of one robot are batched as a
/// whole, and islands of several robots robot by robot if this is cheaper. With sparse-bodies, subtrees between
/// constrained bodies are batched. A level that is not compiled in, or that the processor lacks, acts as kOff.
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

/// The number formats of a solve, in this order: terms of K and of the right-hand side; factor of K; residuals of
/// iterative refinement. Derivatives and products at the solution are always computed in double.
enum class Precision {
  kSingle,    // float, float, no refinement: errors of about 1e-7 times the condition number of K
  kDouble,    // double, double, double
  kExtended,  // double-double, double, double-double. If cond(K) < 1e15, errors of a and f are at most 4 eps of
              // their largest entries. Derivatives and products are those of kDouble at this solution.
};
inline constexpr Precision kPrecisions[] = {Precision::kSingle, Precision::kDouble, Precision::kExtended};
std::string to_string(Precision precision);  // "single", "double", "extended"
/// Returns the precision to which to_string gives this name; nullopt if there is none.
std::optional<Precision> precision_from_string(const std::string& name);

inline constexpr int kMostThreads = 4096;  // larger numbers of threads are refused

struct Options {  // Options of a solve.
  Method method = Method::kAuto;
  std::optional<Order> order;  // for methods with has_order; none: the order of least predicted cost
  SimdLevel simd_level = SimdLevel::kAuto;
  /// Threads of OpenMP, at most kMostThreads, inside a call of solve, differentiate, jvp or vjp. They share islands,
  /// SIMD batches, and the robots of a large island. 0 takes as many threads as OpenMP offers.
  ///
  /// Results do not depend on the number of threads.
  int threads = 1;
  /// Whether the rows of several contacts between the same two bodies are reduced to at most six independent rows
  /// before the factorization. This requires a Scene::tolerance of 0 and contacts in A's axes. Dependent rows that are
  /// not reduced are found in K. Methods kDense and kDenseSchur never reduce rows.
  bool reduce_pairs = true;
  /// The precision of the solve. Islands that this precision cannot solve are solved in kDouble.
  /// IslandReport::precision is the precision used. IslandReport::reason is then kLowPrecision, unless there is another
  /// reason.
  ///
  /// kSingle requires islands of one robot that sparse-ldl solves in SIMD batches, without dependent rows or two
  /// contacts between the same bodies. A kSingle solution is rejected if rounding may change the largest acceleration
  /// or force by more than 1 %. Derivatives, products and error bounds are computed in double at the solution, so those
  /// of kSingle are as accurate as its accelerations and forces.
  Precision precision = Precision::kDouble;
  bool operator==(const Options&) const = default;
};

}  // namespace manycontact
