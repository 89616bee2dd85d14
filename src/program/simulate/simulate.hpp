#pragma once
// Functions that `manycontact simulate`, `manycontact optimize` and `manycontact stability` share.

#include "../files/csv_file.hpp"
#include "manycontact/detail/simulation/invariants.hpp"
#include "manycontact/io/scene_file.hpp"
#include "manycontact/simulation/gains.hpp"
#include "manycontact/simulation/step.hpp"

namespace manycontact::cli {

void set_gains(Scene& scene, const Gains& gains);

/// Parses two numbers such as "25 10" or "25,10". Throws UsageError with the message "expected 'alpha beta'" +
/// otherwise, with `names` for 'alpha beta'.
Gains two_numbers(const std::string& option, const std::string& names, const std::string& text,
                  const std::string& otherwise = "");

/// Write t, q, v, constraint errors, energy and momentum: the first function the header, the second one row per state.
void write_trajectory_header(const Scene& scene, CsvFile& csv);
void write_trajectory_row(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Invariants& at,
                          CsvFile& csv);

/// Write t and the forces of all contacts in their reference frames in columns such as "f:left[0]", with 0 for inactive
/// contacts. The forces belong to the state at the start of sim's last step.
void write_forces_header(const Scene& scene, CsvFile& csv);
void write_forces_row(double t, const Scene& scene, const SimulationData& sim, CsvFile& csv);

}  // namespace manycontact::cli
