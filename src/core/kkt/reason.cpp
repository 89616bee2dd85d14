#include "manycontact/kkt/reason.hpp"

#include "manycontact/model/named.hpp"

namespace manycontact {

std::string to_string(Reason reason) {
  static constexpr Named<Reason> kNames[] = {
      {Reason::kNone, "none"},
      {Reason::kZeroPivot, "a pivot was zero"},
      {Reason::kWrongInertia, "the inertia of K was not (nv, nc, 0)"},
      {Reason::kSmallPivot, "a pivot was lost in cancellation: dependent contact rows, or nearly"},
      {Reason::kLargeResidual, "refinement did not reach a small residual"},
      {Reason::kNotFinite, "the state, the torques or the system is not finite"},
      {Reason::kDampingLost, "the damping is lost in rounding; solved without damping"},
      {Reason::kBadDamping, "the damping is negative or not finite"},
      {Reason::kBadQuaternion, "a quaternion is not of unit length"},
      {Reason::kSingularInertia, "the inertia is singular in directions without constraint"},
      {Reason::kSpringWithoutDirection, "the ends of a spring coincide, so that its force has no direction"},
      {Reason::kBadMomentLength, "the scene's moment_length is not a finite number above 0"},
      {Reason::kUncertain, "rounding may change the solution by more than its size"},
      {Reason::kLowPrecision, "the island cannot be solved in the precision asked for, and was solved in double"},
  };
  return name_of(kNames, reason);
}

}  // namespace manycontact
