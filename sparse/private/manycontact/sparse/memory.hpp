#pragma once
// Requests for more memory than the machine has are refused early: the system would grant them and end the program
// later.

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

/// Doubles that start at a cache line, in large pages where the system has them. Their values are not kept.
class LargeMemory {
 public:
  /// Memory for `count`; allocates where there was less.
  void reserve(std::size_t count);
  double* data() const { return data_.get(); }

 private:
  struct Free {
    void operator()(double* x) const;
  };
  std::unique_ptr<double[], Free> data_;
  std::size_t size_ = 0;
};

/// Throws TooLarge when `bytes` are more than this machine's memory.
void require_memory(double bytes);

}  // namespace manycontact::sparse
