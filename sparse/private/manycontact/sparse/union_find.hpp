#pragma once
#include <algorithm>
#include <numeric>
#include <span>

namespace manycontact::sparse {

/// Disjoint sets of the numbers 0 ... n-1, stored in the caller's memory. The root of a set is its smallest member.
class UnionFind {
 public:
  explicit UnionFind(std::span<int> memory) : parent_(memory.data()) { std::iota(memory.begin(), memory.end(), 0); }
  int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int i, int j) {
    i = root(i), j = root(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  int* parent_;
};

}  // namespace manycontact::sparse
