#include "manycontact/dynamics/report.hpp"

#include <algorithm>

#include "manycontact/model/named.hpp"
#include "manycontact/sparse/largest.hpp"

namespace manycontact {

std::string to_string(Status status) {
  static constexpr Named<Status> kNames[] = {
      {Status::kOk, "ok"},
      {Status::kRedundant, "redundant"},
      {Status::kInconsistent, "inconsistent"},
      {Status::kRegularised, "regularised"},
      {Status::kFailed, "failed"},
  };
  return name_of(kNames, status);
}

void summarise(Report& report) {
  report.status = Status::kOk;
  report.nv = report.nc = report.rank = report.factor_nonzeros = report.refinement_steps = 0;
  report.residual_dynamics = report.residual_contact = report.backward_error = report.condition = 0;
  report.error_acceleration = report.error_forces = 0;
  const auto largest = sparse::larger_or_nan<double>;
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
