#include "manycontact/sparse/dense_kernels.hpp"

#include "simd/levels.hpp"

namespace manycontact::sparse {

const DenseKernels& dense_kernels() {
  static const DenseKernels& best = simd::levels().front().blocks;
  return best;
}

}  // namespace manycontact::sparse
