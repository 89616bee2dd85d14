#pragma once
// What a solve says about its answer, in every build type.

#include <string>
#include <vector>

#include "manycontact/kkt/options.hpp"
#include "manycontact/kkt/reason.hpp"

namespace manycontact {

/// From good to bad; a scene is as bad as its worst island.
enum class Status {
  kOk,
  kRedundant,     // contacts depend on each other and agree: accelerations exact, forces of least norm
  kInconsistent,  // contacts contradict each other: least squares
  kRegularised,   // the answer to a neighbouring problem
  kFailed,        // no answer: accelerations and forces are NaN
};
std::string to_string(Status status);  // "ok", "redundant", ...

struct IslandReport {  // Of one island's answer.
  Status status = Status::kOk;
  Method method = Method::kSparseLdl;  // the one that answered
  Order order = Order::kLeafToRoot;    // its order, where it has one
  Reason reason = Reason::kNone;       // of the last change of order or method, of the failure, or kUncertain
  bool changed_order = false;          // the order chosen was unsound, leaf-to-root answered
  int nv = 0, nc = 0;
  int rank = 0;                     // of J; with damping, nc: K is regular whatever J's rank; 0 when failed
  std::vector<int> dependent_rows;  // delta = 0: rows of data.f that depend on the others, ascending; nc - rank of them
  int factor_nonzeros = 0;          // of L (and the tree's factor), diagonals included
  int refinement_steps = 0;
  double residual_dynamics = 0;  // max |M a - J^T f - tau_b| / max (|M||a| + |J^T||f| + |tau_b|)
  double residual_contact = 0;   // max |J a + a0 + delta f| / max (|J||a| + |a0| + delta |f|, |gravity|)
  double contact_terms = 0;      // max (|J||a| + |a0| + delta |f|): what contradictions are judged beside
  double backward_error = 0;     // max |r_k| / (|b| + |K||x|)_k: how far K and b are from ones solved exactly; of a
                                 // fallback rows that are all rounding are judged beside what they are rounded from
  double condition = 0;          // 1-norm condition of K, by estimate_condition; 0: not asked for
  /// Bounds of the largest errors of a and of f, relative to the largest a and f, by estimate_errors; 0: not known.
  /// Above 1 nothing of them is known but their size: they are rounding, as accelerations are in a scene at rest; or
  /// the answer is no more than that of a neighbouring problem (Reason::kUncertain).
  double error_acceleration = 0, error_forces = 0;
};

struct Report {  // Of the whole scene's answer.
  Status status = Status::kOk;
  Method method = Method::kAuto;      // the one asked for
  std::vector<IslandReport> islands;  // with method dense-schur, which takes the scene as one system, a single one

  // sums and maxima over islands
  int nv = 0, nc = 0, rank = 0, factor_nonzeros = 0, refinement_steps = 0;
  double residual_dynamics = 0, residual_contact = 0, backward_error = 0, condition = 0;
  double error_acceleration = 0, error_forces = 0;
};

/// Sums up report.islands into the other fields but `method`.
void summarise(Report& report);

}  // namespace manycontact
