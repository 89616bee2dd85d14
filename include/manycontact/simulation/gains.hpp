#pragma once
// Stability of stabilisation gains for a step size h. With exact dynamics a contact's placement error e obeys
//
//     e'' + beta e' + alpha e = 0      (for 6D contacts to first order in e)
//
// An integrator maps (e, h e') linearly per step. With a = alpha h^2, b = beta h and eigenvalues z, this map is
//
//     semi-implicit Euler   [ 1 - a   1 - b ]    z^2 - (2 - a - b) z + (1 - b) = 0
//                           [  -a     1 - b ]    stable: 0 < b < 2, 0 < a < 4 - 2b        (Jury's criterion)
//                                                double root z: b = 1 - z^2, a = (1 - z)^2; deadbeat z = 0: a = b = 1
//     RK4                   R(hL), R(x) = 1 + x + x^2/2 + x^3/6 + x^4/24, L the roots of L^2 + beta L + alpha = 0
//                                                double root L = -omega: stable for h omega < 2.7853, fastest at 1.5961
//
// A double root is recommended, since it does not oscillate:
//
//     semi-implicit Euler   z = 1/2:         alpha = 1/(4 h^2),  beta = 3/(4 h)   e is halved by every step
//     RK4                   h omega = 1/10:  alpha = omega^2,    beta = 2 omega   e falls to 1/e in ten steps
//
// With Euler, larger gains reduce the constraint error up to the deadbeat gains. The recommended gains leave a margin:
// the step may be doubled (the limit is a = 1, b = 3/2).
//
// With RK4, larger gains do not reduce the error. The inner stages violate the contact by O(h^2) s, where s is the
// contact's curvature times velocity squared, and the gains act on this violation. An error of about (h omega)^2 h^2 s
// remains, of order 2 instead of 4 (Prothero and Robinson, Math. Comp. 28, 1974). It is a hundred times larger at half
// the stable step than at h omega = 1/10. Smaller gains hardly reduce it, and correct initial errors slowly.
//
// The recommended gains are meant for integration errors. A large initial error e would cause an acceleration alpha e
// at once. For such an error, use the gains of a larger step.

#include "manycontact/simulation/integrator.hpp"

namespace manycontact {

struct Gains {                 // Stabilisation gains of a contact.
  double alpha = 0, beta = 0;  // 1/s^2, 1/s
};

/// Returns the recommended gains for steps of h [s]. Throws std::invalid_argument unless h is finite and positive.
Gains recommended_gains(Integrator integrator, double h);

/// Returns the spectral radius of the map of (e, h e'), the long-run factor of |e| per step; 1 without gains.
double error_growth(Integrator integrator, const Gains& gains, double h);

/// Returns the largest step h [s] with error_growth of at most 1: infinite without gains, 0 for unstable gains.
///
///     semi-implicit Euler: 4 / (beta + sqrt(beta^2 + 4 alpha))
///     RK4: the smallest h with |R(hL)| = 1, with a relative error of 1e-9
double largest_stable_step(Integrator integrator, const Gains& gains);

}  // namespace manycontact
