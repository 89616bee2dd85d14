#include "manycontact/kkt/reason.hpp"

#include "manycontact/model/named.hpp"

namespace manycontact {

std::string to_string(Reason reason) {
  static constexpr Named<Reason> kNames[] = {
      {Reason::kNone, "none"},
      {Reason::kZeroPivot, "a pivot was zero"},
      {Reason::kWrongInertia, "the numbers of positive, negative and zero pivots of K were not nv, nc and 0"},
      {Reason::kSmallPivot, "a pivot was lost in cancellation, since contact rows are dependent or nearly dependent"},
      {Reason::kLargeResidual, "refinement did not reach a small residual"},
      {Reason::kNotFinite, "the state, the torques or the system is not finite"},
      {Reason::kDampingLost, "the damping is lost in rounding, and the island was solved without damping"},
      {Reason::kBadDamping, "the damping is negative or not finite"},
      {Reason::kBadQuaternion, "a quaternion is not of unit length"},
      {Reason::kSingularInertia, "the inertia matrix is singular in directions without constraint"},
      {Reason::kSpringWithoutDirection, "the ends of a spring coincide, so that its force has no direction"},
      {Reason::kBadMomentLength, "the scene's moment_length is not a finite number above 0"},
      {Reason::kUncertain, "rounding errors may be larger than the solution"},
      {Reason::kLowPrecision, "the island cannot be solved in the requested precision, and was solved in double"},
  };
  return name_of(kNames, reason);
}

}  // namespace manycontact
