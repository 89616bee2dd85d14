
#include "cholmod_common.hpp"
#include "manycontact/sparse/ldl.hpp"
#include "manycontact/sparse/relaxed_supernodes.hpp"

namespace manycontact::sparse {

LdlCounts ldl_count(const UpperCsc& A) {
  LdlCounts counts;
  if (A.n == 0) return counts;  // CHOLMOD refuses empty matrices
  std::vector<int> parent(A.n), postorder(A.n), below(A.n), first(A.n), level(A.n);
  CholmodCommon common;
  cholmod_sparse pattern = view_of(A, nullptr);
  const bool ran = cholmod_analyze_ordering(&pattern, CHOLMOD_NATURAL, nullptr, nullptr, 0, parent.data(),
                                            postorder.data(), below.data(), first.data(), level.data(), &common);
  common.check(ran, "counts of a factor");
  for (int& entries : below) --entries;  // the diagonal does not count
  const std::vector<char> nested = nearly_nested(parent, below);
  for (int j = 0; j < A.n; ++j) {
    const double entries = below[j];
    counts.nonzeros += entries;
    counts.flops += entries * (entries + 2);
    if (!nested[j]) ++counts.blocks, counts.scattered += entries * entries;
  }
  return counts;
}

}  // namespace manycontact::sparse
