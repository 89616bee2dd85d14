#pragma once
// Iterative refinement of A x = b. Source: Higham, Accuracy and Stability of Numerical Algorithms (2002), ch. 12.

#include <span>

namespace manycontact::sparse {

struct Refinement {
  int steps = 0;                         // number of corrections made
  double backward_error = 0, first = 0;  // backward error after the last, and before the first, correction
};

/// Refines x until the backward error is at most `small`, max_steps corrections are made, or a correction does not
/// halve the error: then only rounding errors remain, or the factor is too inaccurate. The last correction is kept.
/// residual() must compute r = b - A x and return the backward error; it is called steps + 1 times, and NaN ends the
/// refinement. correct() must compute x += A^-1 r.
template <class Residual, class Correct>
Refinement refine(int max_steps, double small, Residual&& residual, Correct&& correct) {
  Refinement out;
  out.first = out.backward_error = residual();
  while (out.steps < max_steps && out.backward_error > small) {
    correct();
    ++out.steps;
    const double before = out.backward_error;
    out.backward_error = residual();
    if (!(out.backward_error < 0.5 * before)) break;
  }
  return out;
}

/// Returns the componentwise backward error max |r_k| / scale_k of r = b - A x, with scale = |b| + |A| |x|. Each
/// scale_k is first raised to eps times the largest scale. `largest` is the largest scale of rows of A x = b that r
/// does not contain. Returns NaN if r has a NaN or if scale is not finite, infinity if r is infinite.
double componentwise_backward_error(std::span<const double> r, std::span<const double> scale, double largest = 0);

}  // namespace manycontact::sparse
