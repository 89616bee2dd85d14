#pragma once
#include <string>

namespace manycontact {

/// Why a factor cannot be used, an island was not answered by the method asked for, or not answered at all.
enum class Reason {
  kNone,
  kZeroPivot,        // a pivot was exactly zero or not finite
  kWrongInertia,     // K's inertia was not (nv, nc, 0)
  kSmallPivot,       // a pivot was lost in cancellation: dependent rows, or nearly
  kLargeResidual,    // refinement did not reach a small residual
  kNotFinite,        // q, v or u is not finite, or K or the right-hand side overflowed
  kDampingLost,      // regularised: the damping is below the rounding of K, the answer is the one without damping
  kBadDamping,       // the scene's damping is negative or not finite
  kBadQuaternion,    // a quaternion in q is further than 1e-6 from unit length
  kSingularInertia,  // M is singular and the contacts do not hold what it lets go
  kSpringWithoutDirection,  // the ends of a spring coincide
  kBadMomentLength,         // the scene's moment_length is not a finite number above 0
  kUncertain,               // rounding may change the answer by more than its size, by estimate_errors
};
std::string to_string(Reason reason);  // in words, for people

}  // namespace manycontact
