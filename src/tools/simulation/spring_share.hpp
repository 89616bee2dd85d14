#pragma once
// Springs in a semi-implicit Euler step. With J the rate of a spring's ends, e its stretch and m what it moves, the
// force is that of the step's end, less a share s of what the velocity at the start contributes:
//
//     -k (e + h J (v+ - s v))        s = 1 - (z / (1 + z))^2,        z = h^2 k / m
//
// An oscillation then obeys v+ = ((1 + s z) v - z x / h) / (1 + z), x+ = x + h v+, of determinant (1 + s z) / (1 + z):
// stable for any z. With z small, the determinant is 1 - z^3, that of the explicit step 1. With z large, the force is
// that of the end: a spring relaxes within a step.

namespace manycontact::internal {

/// s at z = fast.
inline double spring_share(double fast) {
  const double damped = fast < 1e150 ? fast / (1 + fast) : 1;
  return 1 - damped * damped;
}

}  // namespace manycontact::internal
