#pragma once
#include <functional>

namespace manycontact::sparse {

/// Estimate of |A^-1|_1 of a symmetric matrix from solves with it (a lower bound, nearly always within a factor 3).
/// solve: x <- A^-1 x, x of length n. Source: Higham, Algorithm 674 (1988), after Hager (1984).
double inverse_norm_1(int n, const std::function<void(double*)>& solve);

/// |B|_1 itself, from products with B in place: n of them.
double norm_1_by_columns(int n, const std::function<void(double*)>& multiply);

/// The estimate of any n x n matrix B, from products with B and B^T in place.
double norm_1_estimate(int n, const std::function<void(double*)>& multiply,
                       const std::function<void(double*)>& multiply_transposed);

}  // namespace manycontact::sparse
