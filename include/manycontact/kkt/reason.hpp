#pragma once
#include <string>

namespace manycontact {

/// Why a factor cannot be used, why another method than the requested one was used, or why there is no solution.
/// to_string describes each reason in words.
enum class Reason {
  kNone,
  kZeroPivot,               // a pivot was zero or not finite
  kWrongInertia,            // K did not have nv positive and nc negative eigenvalues
  kSmallPivot,              // a pivot was lost in cancellation: rows are dependent, or nearly so
  kLargeResidual,           // refinement did not reach a small residual
  kNotFinite,               // q, v or u is not finite, or K or the right-hand side overflowed
  kDampingLost,             // the damping is below the rounding errors of K; the solution is that without damping
  kBadDamping,              // the scene's damping is negative or not finite
  kBadQuaternion,           // the norm of a quaternion in q differs from 1 by more than 1e-6
  kSingularInertia,         // M is singular, and the contacts do not constrain its null space
  kSpringWithoutDirection,  // the two ends of a spring coincide
  kBadMomentLength,         // the scene's moment_length is not finite and positive
  kUncertain,     // rounding errors may change the solution by more than its size, according to estimate_errors
  kLowPrecision,  // the island cannot be solved in the precision of the options; it was solved in double
};
std::string to_string(Reason reason);  // a description in words

}  // namespace manycontact
