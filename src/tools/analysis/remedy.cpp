#include "manycontact/analysis/remedy.hpp"

namespace manycontact {

namespace {

struct Remedy {
  Status status;
  Reason reason;  // kNone means any reason
  const char* text;
};

constexpr Remedy kRemedies[] = {
    {Status::kOk, Reason::kNone, ""},
    {Status::kRedundant, Reason::kNone,
     "Accelerations need no action. unique_forces lists the forces that are unique, and redistribute_forces "
     "computes other forces with the same accelerations."},
    {Status::kInconsistent, Reason::kNone,
     "Bring q and v into agreement with the contacts (make_consistent, or consistent=\"true\" in a scene file), "
     "or deactivate the contacts that contradictions lists."},
    {Status::kRegularised, Reason::kUncertain,
     "Rounding errors may be as large as the solution: compare error_acceleration and error_forces, and remove "
     "nearly dependent contacts (near_dependent) or set the scene's tolerance."},
    {Status::kRegularised, Reason::kDampingLost,
     "The scene's damping is below the rounding errors of K: set the damping to 0, or increase the damping."},
    {Status::kRegularised, Reason::kNone,
     "Compare with the method dense, remove nearly dependent contacts (near_dependent), or set the scene's "
     "tolerance or damping."},
    {Status::kFailed, Reason::kNotFinite,
     "Check q, v and u for numbers that are not finite, and the robots for extreme masses and lengths."},
    {Status::kFailed, Reason::kBadDamping, "Set the scene's damping to a finite number that is not negative."},
    {Status::kFailed, Reason::kBadQuaternion, "Normalise the quaternions of floating bases in q."},
    {Status::kFailed, Reason::kSingularInertia,
     "Add mass, inertia or armature to the joints that massless_joints lists, or constrain these joints by contacts."},
    {Status::kFailed, Reason::kSpringWithoutDirection,
     "Move the ends of the spring apart, or set the spring's length and damping to 0."},
    {Status::kFailed, Reason::kBadMomentLength, "Set the scene's moment_length to a finite number above 0."},
    {Status::kFailed, Reason::kNone,
     "Use the method auto or dense, since dense-schur fails for redundant contacts; or set the scene's damping "
     "to a small number such as 1e-8."},
};

std::string of(Status status, Reason reason) {
  for (const Remedy& x : kRemedies)
    if (x.status == status && (x.reason == reason || x.reason == Reason::kNone)) return x.text;
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
