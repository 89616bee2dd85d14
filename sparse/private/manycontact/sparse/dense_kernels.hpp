#pragma once
// Products and factors of dense column-major blocks, compiled once per SIMD level (blocks/level.cpp). The functions
// take raw pointers and no Eigen types, since the code of Eigen's types differs between levels.

#include <cstddef>

namespace manycontact::sparse {

struct ConstPanel {
  const double* entries;
  std::ptrdiff_t rows, cols, stride;
};
struct Panel {
  double* entries;
  std::ptrdiff_t rows, cols, stride;
};

struct DenseKernels {
  void (*add_AB)(Panel C, double a, ConstPanel A, ConstPanel B);
  void (*add_AtB)(Panel C, double a, ConstPanel A, ConstPanel B);
  void (*add_ABt)(Panel C, double a, ConstPanel A, ConstPanel B);
  void (*add_lower_AB)(Panel C, double a, ConstPanel A, ConstPanel B);
  void (*add_lower_AtB)(Panel C, double a, ConstPanel A, ConstPanel B);
  void (*add_lower_ABt)(Panel C, double a, ConstPanel A, ConstPanel B);
  bool (*cholesky)(Panel A);  // A <- its Cholesky factor L; false if a pivot is not positive
  void (*solve_L)(ConstPanel L, Panel X);
  void (*solve_Lt)(ConstPanel L, Panel X);
  void (*solve_Lt_right)(ConstPanel L, Panel X);
  void (*add_Ax)(double* y, double a, ConstPanel A, const double* x);
  void (*add_Atx)(double* y, double a, ConstPanel A, const double* x);
  void (*add_Az)(ConstPanel A, const double* z, double* sum, double* scale);
  void (*add_Az_Atw)(ConstPanel A, const double* z, double* sum, double* scale, const double* w, double* sum_t,
                     double* scale_t);
};

const DenseKernels& dense_kernels();  // the widest level that the processor supports

}  // namespace manycontact::sparse
