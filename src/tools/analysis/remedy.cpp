#include "manycontact/analysis/remedy.hpp"

namespace manycontact {

namespace {

std::string of_regularised(Reason reason) {
  switch (reason) {
    case Reason::kUncertain:
      return "Rounding errors may be as large as the solution: compare error_acceleration and error_forces, and remove "
             "nearly dependent contacts (near_dependent) or set the scene's tolerance.";
    case Reason::kDampingLost:
      return "The scene's damping is below the rounding errors of K: set it to 0, or increase it.";
    default:
      return "Compare with the method dense, remove nearly dependent contacts (near_dependent), or set the scene's "
             "tolerance or damping.";
  }
}

std::string of_failed(Reason reason) {
  switch (reason) {
    case Reason::kNotFinite:
      return "Check q, v and u for numbers that are not finite, and the robots for extreme masses and lengths.";
    case Reason::kBadDamping:
      return "Set the scene's damping to a finite number that is not negative.";
    case Reason::kBadQuaternion:
      return "Normalise the quaternions of floating bases in q.";
    case Reason::kSingularInertia:
      return "Add mass, inertia or armature to the joints that massless_joints lists, or constrain them by contacts.";
    case Reason::kSpringWithoutDirection:
      return "Move the ends of the spring apart, or set its length and damping to 0.";
    case Reason::kBadMomentLength:
      return "Set the scene's moment_length to a finite number above 0.";
    default:
      return "Use the method auto or dense, since dense-schur fails for redundant contacts; or set the scene's damping "
             "to a small number such as 1e-8.";
  }
}

std::string of(Status status, Reason reason) {
  switch (status) {
    case Status::kOk:
      return "";
    case Status::kRedundant:
      return "Accelerations need no action. unique_forces lists the forces that are unique, and redistribute_forces "
             "computes others with the same accelerations.";
    case Status::kInconsistent:
      return "Bring q and v into agreement with the contacts (make_consistent, or consistent=\"true\" in a scene "
             "file), "
             "or deactivate the contacts that contradictions lists.";
    case Status::kRegularised:
      return of_regularised(reason);
    case Status::kFailed:
      return of_failed(reason);
  }
  return "";
}

}  // namespace

std::string remedy(const IslandReport& report) { return of(report.status, report.reason); }

std::string remedy(const Report& report) {
  for (const IslandReport& island : report.islands)
    if (island.status == report.status) return remedy(island);
  return of(report.status, Reason::kNone);
}

}  // namespace manycontact
