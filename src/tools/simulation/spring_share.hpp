#pragma once
// Springs in a semi-implicit Euler step. With J the rate of a spring's ends, e its stretch and m the mass it moves, the
// force is that of the step's end without a share s of the contribution of the velocity at the start:
//
//     -k (e + h J (v+ - s v))        s = 1 - (z / (1 + z))^2,        z = h^2 k / m
//
// An oscillation then obeys v+ = ((1 + s z) v - z x / h) / (1 + z), x+ = x + h v+. It is stable for any z: the
// determinant is (1 + s z) / (1 + z). For small z this is 1 - z^3, close to 1 as in the explicit step. For large z the
// force is that of the step's end: a spring relaxes within a step.

namespace manycontact::internal {

/// The share s for z = fast.
inline double spring_share(double fast) {
  const double damped = fast < 1e150 ? fast / (1 + fast) : 1;
  return 1 - damped * damped;
}

}  // namespace manycontact::internal
