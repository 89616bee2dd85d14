#pragma once
#include <cstddef>
#include <optional>

#include "manycontact/spatial/pack.hpp"

namespace manycontact::lanes {

/// Work of one robot, island or contact; once a batch is reserved, of as many as fit in a SIMD batch of W. The
/// arguments are those of Work<W, E>. E: the element, double or float.
template <template <int, class> class Work, int W, class E = double>
class ScalarOrBatch {
 public:
  template <class... Arguments>
  explicit ScalarOrBatch(const Arguments&... arguments) : alone_(arguments...) {}
  template <class... Arguments>
  void reserve_batch(const Arguments&... arguments) {
    if (!together_) together_.emplace(arguments...);
  }
  /// use(work) on the one for so many.
  template <class Use>
  void of(std::size_t count, Use&& use) {
    if (count == 1)
      use(alone_);
    else
      use(*together_);
  }

 private:
  Work<1, E> alone_;
  std::optional<Work<W, E>> together_;
};

}  // namespace manycontact::lanes
