#include "manycontact/dynamics/report.hpp"

#include <algorithm>

namespace manycontact {

std::string to_string(Method method) {
  switch (method) {
    case Method::kDense:
      return "dense";
    case Method::kDenseSchur:
      return "dense-schur";
    case Method::kSparseLdl:
      return "sparse-ldl";
    case Method::kSparseCholmod:
      return "sparse-cholmod";
    case Method::kSparseSupernodal:
      return "sparse-supernodal";
    case Method::kAuto:
      return "auto";
  }
  return "?";
}

std::optional<Method> method_from_string(const std::string& name) {
  for (Method m : kMethods)
    if (to_string(m) == name) return m;
  return std::nullopt;
}

std::optional<Order> order_from_string(const std::string& name) {
  for (Order o : kOrders)
    if (to_string(o) == name) return o;
  return std::nullopt;
}

std::string to_string(Status status) {
  switch (status) {
    case Status::kOk:
      return "ok";
    case Status::kRedundant:
      return "redundant";
    case Status::kInconsistent:
      return "inconsistent";
    case Status::kRegularised:
      return "regularised";
    case Status::kFailed:
      return "failed";
  }
  return "?";
}

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
      return "the damping is lost in rounding; answered without damping";
    case Reason::kBadDamping:
      return "the damping is negative or not finite";
    case Reason::kBadQuaternion:
      return "a quaternion is not of unit length";
    case Reason::kSingularInertia:
      return "the inertia is singular where no contact holds";
  }
  return "?";
}

void summarise(Report& report) {
  report.status = Status::kOk;
  report.nv = report.nc = report.rank = report.factor_nonzeros = report.refinement_steps = 0;
  report.residual_dynamics = report.residual_contact = report.backward_error = report.condition = 0;
  report.error_acceleration = report.error_forces = 0;
  const auto largest = [](double a, double b) { return b <= a ? a : b; };  // keeps NaN
  for (const IslandReport& i : report.islands) {
    report.status = std::max(report.status, i.status);
    report.nv += i.nv;
    report.nc += i.nc;
    report.rank += i.rank;
    report.factor_nonzeros += i.factor_nonzeros;
    report.refinement_steps = std::max(report.refinement_steps, i.refinement_steps);
    report.residual_dynamics = largest(report.residual_dynamics, i.residual_dynamics);
    report.residual_contact = largest(report.residual_contact, i.residual_contact);
    report.backward_error = largest(report.backward_error, i.backward_error);
    report.condition = largest(report.condition, i.condition);
    report.error_acceleration = largest(report.error_acceleration, i.error_acceleration);
    report.error_forces = largest(report.error_forces, i.error_forces);
  }
}

}  // namespace manycontact
