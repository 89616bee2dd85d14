#pragma once
// Subtrees of deep trees (kkt/bodies/subtrees.hpp) in SIMD batches. A subtree between two constrained bodies is short,
// so it is solved and judged in joint space: K = [M J^T; J 0] of its coordinates is small, its order never changes, and
// subtrees of one shape share a batch.

#include <memory>
#include <span>

#include "manycontact/kkt/bodies/factor.hpp"
#include "manycontact/sparse/ldl_schedule.hpp"

namespace manycontact::lanes {

/// Constant; of subtrees of one shape.
struct SubtreePlan {
  explicit SubtreePlan(std::shared_ptr<const BodyPattern> pattern);

  std::shared_ptr<const BodyPattern> pattern;
  sparse::UpperCsc K;  // coordinates from the last to the first, then rows
  sparse::LdlSchedule schedule;
  /// Slots of K. M: per node, the last first, for each of its coordinates those up to it and then the ancestors'. J:
  /// per row, those from body A up to the node where both ends meet, then those from body B.
  std::vector<int> M_slot, J_slot;
  std::vector<int> meeting;  // one entry per row: that node, -1: none

  int place(int coordinate) const { return pattern->nv - 1 - coordinate; }
  int place_of_row(int row) const { return pattern->nv + row; }
  /// Whether subtrees of this shape are small enough for a SIMD batch.
  static bool fits(const BodyPattern& pattern);
};

class SubtreeBatch {
 public:
  struct Subtree {
    const BodySystem* system;  // not damped
    BodySolve* solution;       // solution of b: x.joints, x.rows, x.force of the bases; the residual's largest entries
    // set by solve
    bool sound;  // false: nothing else is known and another system has to solve
    int factor_nonzeros;
    sparse::Refinement refinement;
  };
  virtual ~SubtreeBatch() = default;
  /// Solves as many subtrees as fit in a SIMD batch, or fewer.
  virtual void solve(std::span<Subtree> subtrees) = 0;
};

}  // namespace manycontact::lanes
