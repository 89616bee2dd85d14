#pragma once
#include <functional>

namespace manycontact::sparse {

/// Estimates |A^-1|_1 of a symmetric n x n matrix A. The estimate is a lower bound, nearly always within a factor of 3.
/// solve(x) must overwrite x with A^-1 x. Source: Higham, Algorithm 674 (1988), after Hager (1984).
double inverse_norm_1(int n, const std::function<void(double*)>& solve);

/// Computes |B|_1 of an n x n matrix B from its n columns, without an estimate. multiply(x) must overwrite x with B x.
double norm_1_by_columns(int n, const std::function<void(double*)>& multiply);

/// Estimates |B|_1 of an n x n matrix B by a lower bound. The functions must overwrite x with B x and with B^T x.
double norm_1_estimate(int n, const std::function<void(double*)>& multiply,
                       const std::function<void(double*)>& multiply_transposed);

}  // namespace manycontact::sparse
