#include "manycontact/kkt/reason.hpp"

namespace manycontact {

std::string to_string(Reason reason) {
  switch (reason) {
    case Reason::kNone:
      return "none";
    case Reason::kZeroPivot:
      return "a pivot was zero";
    case Reason::kWrongInertia:
      return "the inertia of K was not (nv, nc, 0)";
    case Reason::kSmallPivot:
      return "a pivot was lost in cancellation: dependent contact rows, or nearly";
    case Reason::kLargeResidual:
      return "refinement did not reach a small residual";
    case Reason::kNotFinite:
      return "the state, the torques or the system is not finite";
    case Reason::kDampingLost:
      return "the damping is lost in rounding; solved without damping";
    case Reason::kBadDamping:
      return "the damping is negative or not finite";
    case Reason::kBadQuaternion:
      return "a quaternion is not of unit length";
    case Reason::kSingularInertia:
      return "the inertia is singular in directions without constraint";
    case Reason::kSpringWithoutDirection:
      return "the ends of a spring coincide, so that its force has no direction";
    case Reason::kBadMomentLength:
      return "the scene's moment_length is not a finite number above 0";
    case Reason::kUncertain:
      return "rounding may change the solution by more than its size";
    case Reason::kLowPrecision:
      return "the island cannot be solved in the precision asked for, and was solved in double";
  }
  return "?";
}

}  // namespace manycontact
