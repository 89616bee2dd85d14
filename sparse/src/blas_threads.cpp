#include "manycontact/sparse/blas_threads.hpp"

#include <dlfcn.h>

namespace manycontact::sparse {

namespace {

// A function of OpenBLAS, which is chosen when the program starts: null where another BLAS was.
template <class Function>
Function* of_openblas(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

}  // namespace

OneBlasThread::OneBlasThread() : before_(0) {
  static const auto get = of_openblas<int()>("openblas_get_num_threads");
  static const auto set = of_openblas<void(int)>("openblas_set_num_threads");
  if (!get || !set || get() <= 1) return;
  before_ = get();
  set(1);
}

OneBlasThread::~OneBlasThread() {
  static const auto set = of_openblas<void(int)>("openblas_set_num_threads");
  if (before_ > 0) set(before_);
}

}  // namespace manycontact::sparse
