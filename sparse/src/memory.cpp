#include "manycontact/sparse/memory.hpp"

#include <unistd.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

#include <cstdio>
#include <cstdlib>

namespace manycontact::sparse {

namespace {
double memory() {
  static const double bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return bytes;
}
}  // namespace

TooLarge::TooLarge(double bytes) {
  std::snprintf(text_, sizeof text_, "an island's system would take %.2g GB or more, this machine has %.2g GB",
                bytes / 1e9, memory() / 1e9);
}

void require_memory(double bytes) {
  if (bytes > memory()) throw TooLarge(bytes);
}

void LargeMemory::reserve(std::size_t count) {
  if (count <= size_) return;
  constexpr std::size_t kPage = std::size_t{1} << 21, kLine = 64;
  const std::size_t align = count * sizeof(double) < kPage ? kLine : kPage;
  const std::size_t bytes = (count * sizeof(double) + align - 1) / align * align;
  data_.reset();
  size_ = 0;
  data_.reset(static_cast<double*>(std::aligned_alloc(align, bytes)));
  if (!data_) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  if (align == kPage) (void)madvise(data_.get(), bytes, MADV_HUGEPAGE);  // only a hint
#endif
  size_ = count;
}

void LargeMemory::Free::operator()(double* x) const { std::free(x); }

}  // namespace manycontact::sparse
