#pragma once
// Solves subtrees of deep trees (kkt/bodies/subtrees.hpp) in SIMD batches. A subtree's K = [M J^T; J 0] in joint space
// is small, and has a fixed elimination order. Subtrees of one shape share a batch.

#include <memory>
#include <span>

#include "manycontact/kkt/bodies/factor.hpp"
#include "manycontact/sparse/ldl_schedule.hpp"

namespace manycontact::lanes {

struct SubtreePlan {  // constant data of subtrees of one shape
  explicit SubtreePlan(std::shared_ptr<const BodyPattern> pattern);

  std::shared_ptr<const BodyPattern> pattern;
  sparse::UpperCsc K;  // pattern of K; coordinates from the last to the first, then contact rows
  sparse::LdlSchedule schedule;
  /// Slots in K, in order of assembly. M_slot: per coordinate k, from the last node to the first, the entries (k, j), j
  /// of k's node up to k, then of ancestors. J_slot: per row, coordinates from A up to `meeting`, then from B.
  std::vector<int> M_slot, J_slot;
  std::vector<int> meeting;  // one per row: the first common ancestor node of both bodies; -1: none

  int place(int coordinate) const { return pattern->nv - 1 - coordinate; }
  int place_of_row(int row) const { return pattern->nv + row; }
  static bool fits(const BodyPattern& pattern);  // whether subtrees of this shape are small enough for a SIMD batch
};

class SubtreeBatch {
 public:
  struct Subtree {
    const BodySystem* system;  // not damped
    BodySolve* solution;       // input b; output x.joints, x.rows, x.force of the bases, largest residuals
    bool sound;                // set by solve; false: other results are undefined, and another system must solve
    int factor_nonzeros;
    sparse::Refinement refinement;
  };
  virtual ~SubtreeBatch() = default;
  virtual void solve(std::span<Subtree> subtrees) = 0;  // solves up to a full SIMD batch
};

}  // namespace manycontact::lanes
