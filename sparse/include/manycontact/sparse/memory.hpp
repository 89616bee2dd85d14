#pragma once
// More memory than there is, refused before it is asked for: the system would promise it and end the program later.

#include <new>

namespace manycontact::sparse {

struct TooLarge : std::bad_alloc {
  explicit TooLarge(double bytes);
  const char* what() const noexcept override { return text_; }

 private:
  char text_[120];
};

/// Throws TooLarge when `bytes` are more than this machine's memory.
void require_memory(double bytes);

}  // namespace manycontact::sparse
