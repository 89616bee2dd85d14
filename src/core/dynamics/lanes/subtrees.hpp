#pragma once
// Subtrees of deep trees (kkt/bodies/subtrees.hpp) in SIMD batches. They are short, so they are solved in joint space:
// K = [M J^T; J 0] is small, its order is fixed, and subtrees of one shape share a batch.

#include <memory>
#include <span>

#include "manycontact/kkt/bodies/factor.hpp"
#include "manycontact/sparse/ldl_schedule.hpp"

namespace manycontact::lanes {

/// Constant data of subtrees of one shape.
struct SubtreePlan {
  explicit SubtreePlan(std::shared_ptr<const BodyPattern> pattern);

  std::shared_ptr<const BodyPattern> pattern;
  sparse::UpperCsc K;  // order: coordinates from the last to the first, then rows
  sparse::LdlSchedule schedule;
  /// Slots in K. M: from the last node on, each coordinate's entries with those of its node up to itself, then with the
  /// ancestors'. J: per row, the coordinates from body A up to the node where both ends meet, then those from body B.
  std::vector<int> M_slot, J_slot;
  std::vector<int> meeting;  // node where both ends of each row meet; -1: none

  int place(int coordinate) const { return pattern->nv - 1 - coordinate; }
  int place_of_row(int row) const { return pattern->nv + row; }
  /// Whether subtrees of this shape are small enough for a SIMD batch.
  static bool fits(const BodyPattern& pattern);
};

class SubtreeBatch {
 public:
  struct Subtree {
    const BodySystem* system;  // not damped
    BodySolve* solution;       // input b; output x.joints, x.rows, x.force of the bases, largest residuals
    bool sound;                // set by solve; false: another system must solve, and all other results are undefined
    int factor_nonzeros;
    sparse::Refinement refinement;
  };
  virtual ~SubtreeBatch() = default;
  /// Solves up to a full SIMD batch of subtrees.
  virtual void solve(std::span<Subtree> subtrees) = 0;
};

}  // namespace manycontact::lanes
