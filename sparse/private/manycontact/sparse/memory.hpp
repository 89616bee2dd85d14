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

/// Memory for doubles, aligned to a cache line, in large pages if possible. Growing discards the stored values.
class LargeMemory {
 public:
  void reserve(std::size_t count);  // allocates only if there is memory for fewer doubles
  double* data() const { return data_.get(); }

 private:
  struct Free {
    void operator()(double* x) const;
  };
  std::unique_ptr<double[], Free> data_;
  std::size_t size_ = 0;
};

void require_memory(double bytes);  // throws TooLarge if `bytes` exceed this machine's memory

}  // namespace manycontact::sparse
