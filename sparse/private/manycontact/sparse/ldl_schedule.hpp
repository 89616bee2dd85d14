#pragma once
// The numeric phase of A = L D L^T for ldl_kernels.hpp, as lists of L's entries that each step reads and writes.
// Columns of L whose patterns nest (a chain of joints, a base, the rows of a contact) form a block. Its rows are
// numbered as in its first column: the block's own columns, then the rows below. Row r > c in the block's column c is
// Lx[Lp[first + c] + r - c - 1].
//
// The rows below a block are divided into runs: consecutive rows within one other block T. A run's rows, and the rows
// after them, appear in T in the same order, in few contiguous stretches: the run's targets.

#include <cstddef>
#include <limits>
#include <vector>

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::sparse {

struct LdlSchedule {
  /// Rows begin ... end-1 below a block: rows row, row + 1, ... of A, which are columns of block T with first column
  /// `first`. The positions in T of these and all later rows are targets[target] ... targets[target_end-1].
  struct Run {
    int begin, end;
    int row, first;
    int target, target_end;
  };
  /// Row b below the block, begin <= b < end, is row b + shift of block T.
  struct Target {
    int begin, end, shift;
  };
  static constexpr int kWidest = 32;  // largest number of columns of a block; larger blocks are divided
  /// A group of rows row ... row+high-1 that a panel solve computes together in x <- L^-T D^-1 x. They depend on the
  /// rows in segments[segment] ... segments[segment_end-1], which have larger indices. There, rows computed last come
  /// last, so that no operation waits for their values. packed[at] and the following numbers are the slots of L's
  /// entries in the group's columns, for each row of the segments, then for rows row+1 ... row+high-1 of the group.
  struct Group {
    int row, high;
    int segment, segment_end;
    int at;
  };
  struct Segment {  // rows row, row - 1, ..., row - count + 1 of x
    int row, count;
  };
  static constexpr int kHigh = 4;

  int n = 0;
  int eliminated = 0;         // number of eliminated blocks; later blocks are the Schur complement
  std::vector<int> diagonal;  // slot of A_kk in A's values, per row k
  std::vector<int> from, to;  // slots of A's off-diagonal entries in A; slots of these in L
  std::vector<int> fill;      // slots of L without an entry of A (fill-in)
  std::vector<int> Lp;        // column starts as in LdlSymbolic; empty if the schedule is not compiled
  std::vector<int> block;     // block k has columns block[k] ... block[k+1]-1
  std::vector<int> run;       // block k has runs[run[k]] ... runs[run[k+1]-1]
  std::vector<Run> runs;
  std::vector<Target> targets;
  std::vector<Group> groups;  // groups of rows of x, the last rows first
  std::vector<Segment> segments;
  std::vector<int> packed;  // slots in L of the entries that groups use; -1: an entry that is zero

  bool compiled() const { return !Lp.empty(); }  // false: its targets would need too much memory
  int nonzeros() const { return Lp.back(); }
  int blocks() const { return static_cast<int>(block.size()) - 1; }
  std::size_t bytes() const;
};

/// Compiles the schedule of A for the elimination of `columns` columns; the rest of L and D is the Schur complement,
/// with its diagonal in D. If the targets would take more than four times the memory of L, the result is not compiled.
LdlSchedule compile_ldl(const UpperCsc& A, const LdlSymbolic& symbolic, int columns = std::numeric_limits<int>::max());

}  // namespace manycontact::sparse
