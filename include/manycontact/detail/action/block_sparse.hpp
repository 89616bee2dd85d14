#pragma once
// A sparse matrix that is the sum of small dense blocks. Its pattern is computed once.

#include <Eigen/SparseCore>
#include <vector>

#include "manycontact/abi.hpp"

namespace manycontact {

class BlockSparse {  // A sparse matrix made of dense blocks.
 public:
  void clear() { planned_.clear(); }  // removes all blocks
  /// Adds a block to the pattern; returns its number. rows[i], cols[j]: matrix indices of the block's rows and columns.
  std::size_t plan(const std::vector<int>& rows, const std::vector<int>& cols);
  std::size_t size() const { return planned_.size(); }  // the number of blocks
  void finish(int rows, int cols);                      // computes the pattern of all blocks

  void set_zero();  // sets all values to zero
  /// Returns the index of a block's first number in the array of the matrix's values.
  std::size_t entry(std::size_t block) const { return static_cast<std::size_t>(planned_[block].slots[0]); }
  /// Computes matrix += weight * values in the entries of a block. values: as many rows and columns as the block has.
  template <class Derived>
  void add(std::size_t block, double weight, const Eigen::MatrixBase<Derived>& values) {
    double* A = matrix.valuePtr();
    Eigen::Index at = 0;  // index in values, column by column
    for (const Run& run : planned_[block].runs) {
      const Eigen::Index i = at % values.rows(), j = at / values.rows();
      for (int k = 0; k < run.count; ++k) A[run.slot + k] += weight * values(i + k, j);
      at += run.count;
    }
  }

  /// Computes matrix += weight * (selected rows of `values`) in a block, which has as many rows as `rows`.
  template <class Derived>
  void add(std::size_t block, double weight, const Eigen::MatrixBase<Derived>& values, const std::vector<int>& rows) {
    double* A = matrix.valuePtr();
    const int* slot = planned_[block].slots.data();
    for (Eigen::Index j = 0; j < values.cols(); ++j)
      for (int i : rows) A[*slot++] += weight * values(i, j);
  }

  Eigen::SparseMatrix<double> matrix;

 private:
  struct Run {
    int slot, count;  // consecutive slots of one column's entries
  };
  struct Block {
    std::vector<int> rows, cols;
    std::vector<int> slots;  // slot of each entry of the block, column by column
    std::vector<Run> runs;   // the same slots as runs of consecutive slots
  };
  std::vector<Block> planned_;
};

}  // namespace manycontact
