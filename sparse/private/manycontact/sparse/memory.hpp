#pragma once
// Refuses requests for more memory than the machine has. The system would grant them and later kill the process.

#include <cstddef>
#include <memory>
#include <new>

namespace manycontact::sparse {

struct TooLarge : std::bad_alloc {
  explicit TooLarge(double bytes);
  const char* what() const noexcept override { return text_; }

 private:
  char text_[120];
};

/// Memory for doubles, aligned to a cache line; long arrays are in large pages if the system has them. Growing discards
/// the stored values.
class LargeMemory {
 public:
  /// Ensures memory for `count` doubles; allocates only if there is memory for fewer.
  void reserve(std::size_t count);
  double* data() const { return data_.get(); }

 private:
  struct Free {
    void operator()(double* x) const;
  };
  std::unique_ptr<double[], Free> data_;
  std::size_t size_ = 0;
};

/// Throws TooLarge if `bytes` exceed this machine's memory.
void require_memory(double bytes);

}  // namespace manycontact::sparse
