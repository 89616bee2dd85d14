#include "manycontact/sparse/blas_threads.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

namespace manycontact::sparse {
namespace {

TEST(BlasThreads, OneAsLongAsItLives) {
  const auto get = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
  const auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
  if (!get || !set) GTEST_SKIP() << "the BLAS at hand is not OpenBLAS";
  const int before = get();
  set(2);
  {
    const OneBlasThread one;
    EXPECT_EQ(get(), 1);
    const OneBlasThread again;
    EXPECT_EQ(get(), 1);
  }
  EXPECT_EQ(get(), 2);
  set(before);
}

}  // namespace
}  // namespace manycontact::sparse
