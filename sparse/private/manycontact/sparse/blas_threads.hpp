#pragma once

namespace manycontact::sparse {

/// As long as it lives, OpenBLAS, where that is the BLAS at hand, works in one thread: its sums depend on their number.
/// Of the whole program; not for two threads at a time.
class OneBlasThread {
 public:
  OneBlasThread();
  ~OneBlasThread();
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  int before_;  // 0: another BLAS, or one thread already
};

}  // namespace manycontact::sparse
