#pragma once
// The numbers of one island's KKT system, K x = b with x = [a; -f], b = [tau_b; -a0], in a pattern's elimination order.

#include <memory>
#include <span>

#include "manycontact/kkt/pattern.hpp"

namespace manycontact {

struct KktSystem {
  std::shared_ptr<const KktPattern> pattern;
  std::vector<double> Kx;        // K's values, in the pattern's slots
  std::vector<double> b, x;      // in elimination order
  std::vector<double> r, scale;  // residual b - K x, and |b| + |K| |x|

  /// Takes a pattern and the memory it needs.
  void reset(std::shared_ptr<const KktPattern> p);
};

/// Writes K's values into their slots. M: per robot its packed inertia, J: per contact its J by columns, in the
/// island's order.
void assemble(std::span<const std::span<const double>> M, std::span<const std::span<const double>> J, double delta,
              KktSystem& system);

/// Componentwise backward error max |r_k| / scale_k of x, r and scale being updated. Rows whose scale is below eps
/// times the largest count as if it were eps times the largest. NaN when x is not finite.
double backward_error(KktSystem& system);

struct Refinement {
  int steps = 0;
  double backward_error = 0, first = 0;  // last, and before the first step
};

/// Iterative refinement on the true residual: x += K^-1 r until the backward error is a few eps or stops falling.
/// solve(double*): in place with the factor at hand. Source: Higham, Accuracy and Stability (2002), ch. 12.
template <class Solve>
Refinement refine(KktSystem& s, int max_steps, Solve&& solve) {
  constexpr double kSmall = 1e-15;
  Refinement out;
  out.first = out.backward_error = backward_error(s);
  while (out.steps < max_steps && out.backward_error > kSmall) {
    solve(s.r.data());
    for (std::size_t k = 0; k < s.x.size(); ++k) s.x[k] += s.r[k];
    ++out.steps;
    const double before = out.backward_error;
    out.backward_error = backward_error(s);
    if (!(out.backward_error < 0.5 * before)) break;
  }
  return out;
}

}  // namespace manycontact
