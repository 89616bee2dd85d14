#pragma once
// The numeric phase of A = L D L^T, compiled for ldl_kernels.hpp: the entries of L that each step reads and writes.
//
// Columns whose patterns nest (a chain of joints, a base, the rows of a contact) form a block. Within a block rows are
// numbered as in its first column: first the block's own columns, then the rows below. The columns start with a dense
// triangle; the entry of
//
//   row r > c in the block's column c is Lx[Lp[first + c] + r - c - 1].
//
// The rows below a block are divided into runs of consecutive rows, each within one block T. A run's rows and the rows
// after it are rows of T in the same order, in few contiguous stretches: the targets of the run.

#include <cstddef>
#include <limits>
#include <vector>

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::sparse {

/// The schedule of a pattern: constant, and shared by all matrices with that pattern.
struct LdlSchedule {
  /// Rows begin ... end-1 below a block: they are rows row, row + 1, ... of A, and columns of a block T whose first
  /// column is `first`. The rows from this run on have the positions targets[target] ... targets[target_end-1] in T.
  struct Run {
    int begin, end;
    int row, first;
    int target, target_end;
  };
  /// Row b below the block, begin <= b < end, is row b + shift of block T.
  struct Target {
    int begin, end, shift;
  };
  static constexpr int kWidest = 32;  // most columns of a block; wider ones are divided
  /// Rows row ... row+high-1 of x = L^T \ (D \ x), which a panel solve computes together. They need the rows in
  /// segments[segment] ... segments[segment_end-1], all behind them; rows computed most recently are last, so that no
  /// operation waits for them. Packed from `at` on are L's entries in the group's columns for each of these rows, then
  /// for rows row+1 ... row+high-1, with zeros where L has none.
  struct Group {
    int row, high;
    int segment, segment_end;
    int at;
  };
  struct Segment {  // rows row, row - 1, ..., row - count + 1
    int row, count;
  };
  static constexpr int kHigh = 4;

  int n = 0;
  int eliminated = 0;         // number of eliminated blocks; the blocks after them contain the Schur complement
  std::vector<int> diagonal;  // slot of A_kk
  std::vector<int> from, to;  // slots of A's off-diagonal entries, and their slots in L
  std::vector<int> fill;      // slots of L where A has no entry
  std::vector<int> Lp;        // column starts, see LdlSymbolic; empty if the schedule is not compiled
  std::vector<int> block;     // block k has columns block[k] ... block[k+1]-1
  std::vector<int> run;       // block k has runs[run[k]] ... runs[run[k+1]-1]
  std::vector<Run> runs;
  std::vector<Target> targets;
  std::vector<Group> groups;  // the last rows first
  std::vector<Segment> segments;
  std::vector<int> packed;  // slots of L; -1: a zero

  /// Whether the schedule is compiled; false if it would take too much memory, see compile_ldl.
  bool compiled() const { return !Lp.empty(); }
  int nonzeros() const { return Lp.back(); }
  int blocks() const { return static_cast<int>(block.size()) - 1; }
  std::size_t bytes() const;
};

/// Compiles the schedule of A from its analysis. It is not compiled if targets would take more than four times the
/// memory of L's pattern and values: SuiteSparse's numeric phase needs no lists for such patterns without nested
/// columns. columns: number of columns to eliminate; L and D then end in the Schur complement, whose diagonal is in D.
LdlSchedule compile_ldl(const UpperCsc& A, const LdlSymbolic& symbolic, int columns = std::numeric_limits<int>::max());

}  // namespace manycontact::sparse
