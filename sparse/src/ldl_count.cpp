// Entries of L's columns without L. Row i of L is a subtree of the elimination tree: with root i, and leaves among the
// entries of A's row i. Column j has an entry for each row subtree that j is in. Give each leaf of a row subtree weight
// 1, and take 1 from where the paths of two neighbouring leaves meet and from the root's parent: sums of these weights
// over the subtree below j count the rows that contain j.

#include <numeric>
#include <utility>

#include "manycontact/sparse/ldl.hpp"
#include "manycontact/sparse/relaxed_supernodes.hpp"

namespace manycontact::sparse {

namespace {

// Root of i's tree so far; all nodes passed on the way point there from now on.
int root_of(std::vector<int>& ancestor, int i) {
  int root = i;
  while (ancestor[root] != root) root = ancestor[root];
  while (ancestor[i] != root) i = std::exchange(ancestor[i], root);
  return root;
}

std::vector<int> parents_of(const UpperCsc& A) {
  std::vector<int> parent(A.n, -1), ancestor(A.n);
  std::iota(ancestor.begin(), ancestor.end(), 0);
  for (int k = 0; k < A.n; ++k)
    for (int q = A.p[k]; q < A.p[k + 1]; ++q)
      if (const int root = root_of(ancestor, A.i[q]); root != k) parent[root] = ancestor[root] = k;
  return parent;
}

// Children before parents, subtree after subtree.
std::vector<int> postorder(const std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> child(n + 1, -1), sibling(n, -1), order, stack;
  for (int k = n - 1; k >= 0; --k) {
    int& first = child[parent[k] < 0 ? n : parent[k]];
    sibling[k] = std::exchange(first, k);
  }
  order.reserve(n);
  for (int root = child[n]; root >= 0; root = sibling[root]) {
    stack.assign(1, root);
    while (!stack.empty()) {
      const int top = stack.back(), next = std::exchange(child[top], -1);
      if (next < 0) {
        order.push_back(top);
        stack.pop_back();
      } else {
        child[top] = sibling[next];
        stack.push_back(next);
      }
    }
  }
  return order;
}

}  // namespace

LdlCounts ldl_count(const UpperCsc& A) {
  const int n = A.n;
  const std::vector<int> parent = parents_of(A), post = postorder(parent);
  std::vector<int> first(n, -1);  // place in postorder of the first node below each
  std::vector<long long> weight(n, 0);
  for (int k = 0; k < n; ++k) {
    if (first[post[k]] < 0) weight[post[k]] = 1;  // a leaf of the whole tree: of its own row's subtree
    for (int j = post[k]; j >= 0 && first[j] < 0; j = parent[j]) first[j] = k;
  }
  std::vector<int> begin(n + 1, 0), row(A.nonzeros());  // A's lower triangle by columns
  for (int q = 0; q < A.nonzeros(); ++q) ++begin[A.i[q] + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<int> at(begin.begin(), begin.end() - 1);
  for (int j = 0; j < n; ++j)
    for (int q = A.p[j]; q < A.p[j + 1]; ++q) row[at[A.i[q]]++] = j;
  std::vector<int> ancestor(n), furthest(n, -1), leaf(n, -1);  // row i's subtree: its last leaf, and `first` of that
  std::iota(ancestor.begin(), ancestor.end(), 0);
  for (int k = 0; k < n; ++k) {
    const int j = post[k];
    if (parent[j] >= 0) --weight[parent[j]];  // j's own row ends at j
    for (int q = begin[j]; q < begin[j + 1]; ++q) {
      const int i = row[q];
      if (i == j || first[j] <= furthest[i]) continue;  // not a leaf of row i's subtree
      furthest[i] = first[j];
      ++weight[j];
      if (leaf[i] >= 0) --weight[root_of(ancestor, leaf[i])];
      leaf[i] = j;
    }
    if (parent[j] >= 0) ancestor[j] = parent[j];
  }
  LdlCounts counts;
  for (int k = 0; k < n; ++k)
    if (const int j = post[k]; parent[j] >= 0) weight[parent[j]] += weight[j];
  std::vector<int> below(n);  // the diagonal
  for (int j = 0; j < n; ++j) {
    below[j] = static_cast<int>(weight[j] - 1);
    const double entries = below[j];
    counts.nonzeros += entries;
    counts.flops += entries * (entries + 2);
  }
  const std::vector<char> nested = nearly_nested(parent, below);
  for (int j = 0; j < n; ++j)
    if (const double entries = below[j]; !nested[j]) ++counts.blocks, counts.scattered += entries * entries;
  return counts;
}

}  // namespace manycontact::sparse
