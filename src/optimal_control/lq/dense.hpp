#pragma once
// Products and factorizations of dense column-major blocks for the direction solvers.

#include "manycontact/lq/block_diagonal.hpp"

namespace manycontact::lq {

using MatrixMap = Eigen::Map<MatrixXd>;
/// Returns the first rows x cols numbers of a workspace as a matrix.
inline MatrixMap as_matrix(std::vector<double>& scratch, Index rows, Index cols) {
  return {scratch.data(), rows, cols};
}
using Segment = Eigen::Ref<VectorXd>;
using ConstSegment = const Eigen::Ref<const VectorXd>&;

void add_AB(Block C, double a, ConstBlock A, ConstBlock B);         // C += a A B
void add_AtB(Block C, double a, ConstBlock A, ConstBlock B);        // C += a A^T B
void add_ABt(Block C, double a, ConstBlock A, ConstBlock B);        // C += a A B^T
void add_lower_AB(Block C, double a, ConstBlock A, ConstBlock B);   // C += a A B, symmetric C: lower triangle
void add_lower_AtB(Block C, double a, ConstBlock A, ConstBlock B);  // C += a A^T B, symmetric C: lower triangle
void add_lower_ABt(Block C, double a, ConstBlock A, ConstBlock B);  // C += a A B^T, symmetric C: lower triangle

void add_Ax(Segment y, double a, ConstBlock A, ConstSegment x);   // y += a A x
void add_Atx(Segment y, double a, ConstBlock A, ConstSegment x);  // y += a A^T x

void copy_lower_to_upper(Block C);

/// Factorizes A = L L^T in the lower triangle of A. Returns false if a pivot is below `least` times its diagonal entry.
[[nodiscard]] bool cholesky(Block A, double least);
void solve_L(ConstBlock L, Block X);         // X <- L^-1 X
void solve_Lt(ConstBlock L, Block X);        // X <- L^-T X
void solve_Lt_right(ConstBlock L, Block X);  // X <- X L^-T

// add_Az adds A z to `sum` and |A| |z| to `scale`. add_Az_Atw also adds A^T w to sum_t and |A|^T |w| to scale_t.
void add_Az(ConstBlock A, const double* z, double* sum, double* scale);
void add_Az_Atw(ConstBlock A, const double* z, double* sum, double* scale, const double* w, double* sum_t,
                double* scale_t);

}  // namespace manycontact::lq
