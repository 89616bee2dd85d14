#include "manycontact/sparse/ordering.hpp"

#include <camd.h>

#include <new>
#include <stdexcept>

namespace manycontact::sparse {

std::vector<int> camd_order(const UpperCsc& A, const std::vector<int>& set) {
  if (A.n == 0) return {};  // CAMD refuses empty matrices
  std::vector<int> perm(A.n);
  double control[CAMD_CONTROL], info[CAMD_INFO];
  camd_defaults(control);
  control[CAMD_AGGRESSIVE] = 1;
  const int* constraint = set.empty() ? nullptr : set.data();
  const int status = ::camd_order(A.n, A.p.data(), A.i.data(), perm.data(), control, info, constraint);
  if (status == CAMD_OUT_OF_MEMORY) throw std::bad_alloc();
  if (status < 0) throw std::invalid_argument("camd_order: not a valid upper triangular pattern or constraint");
  return perm;
}

std::vector<int> inverse(const std::vector<int>& perm) {
  std::vector<int> iperm(perm.size());
  for (std::size_t k = 0; k < perm.size(); ++k) iperm[perm[k]] = static_cast<int>(k);
  return iperm;
}

}  // namespace manycontact::sparse
