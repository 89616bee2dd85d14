#pragma once
#include <functional>

namespace manycontact::sparse {

/// Estimates |A^-1|_1 of a symmetric A from solves with A: a lower bound, nearly always within a factor of 3. solve: x
/// <- A^-1 x, x of length n. Source: Higham, Algorithm 674 (1988), after Hager (1984).
double inverse_norm_1(int n, const std::function<void(double*)>& solve);

/// Computes |B|_1 of an n x n matrix exactly, from n products; multiply: x <- B x.
double norm_1_by_columns(int n, const std::function<void(double*)>& multiply);

/// Estimates |B|_1 of any n x n matrix B: a lower bound, from products x <- B x and x <- B^T x.
double norm_1_estimate(int n, const std::function<void(double*)>& multiply,
                       const std::function<void(double*)>& multiply_transposed);

}  // namespace manycontact::sparse
