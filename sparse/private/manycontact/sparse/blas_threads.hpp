#pragma once

namespace manycontact::sparse {

/// While it lives, OpenBLAS, if that is the BLAS in use, works in one thread: its sums depend on their number. It acts
/// on the whole program; not for two threads at a time.
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
