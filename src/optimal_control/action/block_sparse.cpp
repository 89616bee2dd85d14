#include "manycontact/detail/action/block_sparse.hpp"

#include <algorithm>

#include "manycontact/detail/action/cost_derivatives.hpp"

namespace manycontact {

std::size_t BlockSparse::plan(const std::vector<int>& rows, const std::vector<int>& cols) {
  planned_.push_back({rows, cols, {}, {}});
  return planned_.size() - 1;
}

void BlockSparse::finish(int rows, int cols) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const Block& b : planned_)
    for (int j : b.cols)
      for (int i : b.rows) entries.emplace_back(i, j, 0.0);
  matrix.resize(rows, cols);
  matrix.setFromTriplets(entries.begin(), entries.end());
  for (Block& b : planned_) {
    b.slots.clear();
    b.slots.reserve(b.rows.size() * b.cols.size());
    for (int j : b.cols) {
      const int* first = matrix.innerIndexPtr() + matrix.outerIndexPtr()[j];
      const int* last = matrix.innerIndexPtr() + matrix.outerIndexPtr()[j + 1];
      for (int i : b.rows)
        b.slots.push_back(static_cast<int>(std::lower_bound(first, last, i) - matrix.innerIndexPtr()));
    }
    b.runs.clear();
    for (std::size_t k = 0; k < b.slots.size(); ++k)
      if (k % b.rows.size() != 0 && b.slots[k] == b.slots[k - 1] + 1)
        ++b.runs.back().count;
      else
        b.runs.push_back({b.slots[k], 1});
  }
}

void BlockSparse::set_zero() { std::fill_n(matrix.valuePtr(), matrix.nonZeros(), 0.0); }

void CostDerivatives::resize(std::size_t ndx, std::size_t nu, MatrixStorage s) {
  storage = s;
  Lx.setZero(ndx);
  Lu.setZero(nu);
  const bool dense = has_dense(s);
  Lxx.setZero(dense ? ndx : 0, dense ? ndx : 0);
  Lxu.setZero(dense ? ndx : 0, dense ? nu : 0);
  Luu.setZero(dense ? nu : 0, dense ? nu : 0);
}

}  // namespace manycontact
