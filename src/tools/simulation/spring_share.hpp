#pragma once
// Springs in a semi-implicit Euler step h. J v is the rate at which a spring stretches, e its stretch, k its stiffness
// and m the mass that it moves. The force is that at the end of the step, without a share s of the term h J v:
//
//     -k (e + h J (v+ - s v))        s = 1 - (z / (1 + z))^2,        z = h^2 k / m
//
// An oscillation x then obeys v+ = ((1 + s z) v - z x / h) / (1 + z), x+ = x + h v+. It is stable for any z, because
// the determinant is (1 + s z) / (1 + z). For small z the determinant is 1 - z^3, close to 1 as in the explicit step.
// For large z the force is that at the end of the step, so that a spring relaxes within a step.

namespace manycontact::internal {

/// Returns the share s = 1 - (z / (1 + z))^2 of the start velocity that a spring does not resist. fast: z = h^2 k / m.
inline double spring_share(double fast) {
  const double damped = fast < 1e150 ? fast / (1 + fast) : 1;
  return 1 - damped * damped;
}

}  // namespace manycontact::internal
