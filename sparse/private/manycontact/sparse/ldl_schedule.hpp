#pragma once
// The numeric phase of A = L D L^T, compiled: which entries of L each step reads and writes. ldl_kernels.hpp runs it.
//
// Columns whose patterns nest (a chain of joints, a base, the rows of a contact) form a block. Within a block rows are
// numbered as in its first column: first the block's own columns, then the rows below. Its column c, with a leading
// dense triangle, is
//
//   row r > c of the block in Lx[Lp[first + c] + r - c - 1].
//
// A block's rows below are cut into runs of consecutive rows, none of which leaves a block. Where a run's rows are
// columns of block T, the rows below it are rows of T in the same order, in few stretches: those are its targets.

#include <cstddef>
#include <limits>
#include <vector>

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::sparse {

/// Constant; shared by all matrices of a pattern.
struct LdlSchedule {
  /// Rows begin ... end-1 below a block, which are rows row, row + 1, ... of A and columns of a block that starts at
  /// column `first`. Rows of this run and those below it in that block: targets[target] ... targets[target_end-1].
  struct Run {
    int begin, end;
    int row, first;
    int target, target_end;
  };
  /// Row b below the block, begin <= b < end, is row b + shift of the other block.
  struct Target {
    int begin, end, shift;
  };
  static constexpr int kWidest = 32;  // columns of a block: wider ones are cut
  /// Rows row ... row+high-1 of x = L^T \ (D \ x), which a panel takes at a time: they need those of `segments`
  /// segment ... segment_end-1, all behind them; those known last come last, so that nothing waits for them. Packed
  /// from `at` on: for each of these rows, then for row+1 ... row+high-1, L's entries in the group's columns; zero
  /// where there is none.
  struct Group {
    int row, high;
    int segment, segment_end;
    int at;
  };
  struct Segment {  // rows row, row - 1, ..., so many
    int row, count;
  };
  static constexpr int kHigh = 4;

  int n = 0;
  int eliminated = 0;         // blocks that are; those behind them keep what is left of A
  std::vector<int> diagonal;  // slot of A_kk
  std::vector<int> from, to;  // slots of A's other entries, and where these go in L
  std::vector<int> fill;      // slots of L where A has no entry
  std::vector<int> Lp;        // the same as LdlSymbolic's; empty where the schedule is not compiled
  std::vector<int> block;     // block k has columns block[k] ... block[k+1]-1
  std::vector<int> run;       // and runs[run[k]] ... runs[run[k+1]-1]
  std::vector<Run> runs;
  std::vector<Target> targets;
  std::vector<Group> groups;  // the last rows first
  std::vector<Segment> segments;
  std::vector<int> packed;  // slots of L, -1: zero

  /// False: it would take too much memory, see compile_ldl.
  bool compiled() const { return !Lp.empty(); }
  int nonzeros() const { return Lp.back(); }
  int blocks() const { return static_cast<int>(block.size()) - 1; }
  std::size_t bytes() const;
};

/// symbolic: of A. Not compiled where targets would take more than four times the memory of L's pattern and values:
/// scattered patterns without nesting columns, of which SuiteSparse's numeric phase needs no lists. With `columns`, for
/// so many first columns: L and D end in the Schur complement on the others, whose diagonal is in D.
LdlSchedule compile_ldl(const UpperCsc& A, const LdlSymbolic& symbolic, int columns = std::numeric_limits<int>::max());

}  // namespace manycontact::sparse
