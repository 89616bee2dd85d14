#pragma once

#include "manycontact/task/problem.hpp"

namespace manycontact {

/// Returns for each contact of the scene the force on A in running node t at the problem's last calc, in the contact's
/// reference frame (Runge-Kutta: at the first stage). Forces of inactive contacts, and at an impact, are empty.
std::vector<Eigen::VectorXd> contact_forces(const TaskFile& task, const TaskProblem& problem, std::size_t t);

}  // namespace manycontact
