#pragma once

#include "manycontact/task/problem.hpp"

namespace manycontact {

/// Returns the forces in running node t at the problem's last calc (with RK at its first stage), per contact of the
/// scene, in the contact's reference frame on A. Empty for contacts that are not active, and at an impact.
std::vector<Eigen::VectorXd> contact_forces(const TaskFile& task, const TaskProblem& problem, std::size_t t);

}  // namespace manycontact
