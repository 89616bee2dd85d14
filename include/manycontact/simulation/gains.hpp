#pragma once
// Which gains a step size bears. Exact dynamics make a contact's error obey e'' + beta e' + alpha e = 0 (to first order
// in e for 6D). An integrator makes of it a linear map of (e, h e') per step, with a = alpha h^2, b = beta h:
//
// clang-format off
//   semi-implicit Euler   [ 1 - a   1 - b ]    z^2 - (2 - a - b) z + (1 - b) = 0
//                         [  -a     1 - b ]    stable: 0 < b < 2, 0 < a < 4 - 2b        (Jury)
//                                              double root z: b = 1 - z^2, a = (1 - z)^2; deadbeat z = 0: a = b = 1
//   RK4                   R(hL), R(x) = 1 + x + x^2/2 + x^3/6 + x^4/24, L the roots of L^2 + beta L + alpha = 0
//                                              double root L = -omega: stable for h omega < 2.7853, fastest at 1.5961
// clang-format on
//
// Recommended is a double root, which does not oscillate:
//
// clang-format off
//   semi-implicit Euler   z = 1/2:         alpha = 1/(4 h^2),  beta = 3/(4 h)   e halves with every step
//   RK4                   h omega = 1/10:  alpha = omega^2,    beta = 2 omega   e falls to 1/e in ten steps
// clang-format on
//
// Euler's drift falls all the way to the deadbeat gains; half of that leaves a margin: the step may double (a = 1,
// b = 3/2 is the limit). RK4's does not: its inner stages leave the contact by O(h^2) s, s the contact's curvature
// times velocity squared, and the gains answer: what remains is a drift of about (h omega)^2 h^2 s, order 2 instead of
// 4 (Prothero and Robinson, Math. Comp. 28, 1974). At half the stable step it is a hundred times that at h omega =
// 1/10; below that little is gained where errors come from elsewhere (damping, the start), and they stay longer.
//
// All this is meant for errors of integration. An error e at the start asks for an acceleration alpha e at once: where
// it is large take the gains of a larger step.

#include "manycontact/simulation/integrator.hpp"

namespace manycontact {

struct Gains {                 // Of a contact's stabilisation.
  double alpha = 0, beta = 0;  // 1/s^2, 1/s
};

/// For steps of h. Throws std::invalid_argument unless h is finite and positive.
Gains recommended_gains(Integrator integrator, double h);

/// Spectral radius of the map: what |e| is multiplied by per step in the long run. Without gains 1: errors stay.
double error_growth(Integrator integrator, const Gains& gains, double h);

/// The step beyond which error_growth is above 1: infinite without gains, 0 where the gains themselves are unstable.
///   semi-implicit Euler: 4 / (beta + sqrt(beta^2 + 4 alpha))
///   RK4: the smallest h with |R(hL)| = 1, to 1e-9 of it
double largest_stable_step(Integrator integrator, const Gains& gains);

}  // namespace manycontact
