#pragma once
#include <functional>

namespace manycontact::sparse {

/// Estimates |A^-1|_1 of a symmetric matrix from solves with A (a lower bound, nearly always within a factor of 3).
/// solve: x <- A^-1 x, x of length n. Source: Higham, Algorithm 674 (1988), after Hager (1984).
double inverse_norm_1(int n, const std::function<void(double*)>& solve);

/// Computes |B|_1 exactly, from n products with B in place.
double norm_1_by_columns(int n, const std::function<void(double*)>& multiply);

/// Estimates |B|_1 of any n x n matrix B, from products with B and B^T in place (a lower bound).
double norm_1_estimate(int n, const std::function<void(double*)>& multiply,
                       const std::function<void(double*)>& multiply_transposed);

}  // namespace manycontact::sparse
