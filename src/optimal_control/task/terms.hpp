#pragma once
// The residuals, activations and bounds of a task's terms.

#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"
#include "manycontact/task/problem.hpp"

namespace manycontact::task {

/// The context in which terms are made.
struct Parts {
  const TaskFile& task;
  std::shared_ptr<StateMultibody> state;
  std::shared_ptr<ActuationModelAbstract> actuation;  // null: an impact, which has terms of the state alone
  std::shared_ptr<ContactModelMultiple> contacts;
  std::size_t nu() const { return actuation ? actuation->get_nu() : 0; }
};

/// One of the residuals of a term: of one copy, or of all in one.
struct Residual {
  std::string name;  // the term's, with the copy's number when there are several
  std::shared_ptr<ResidualModelAbstract> model;
  int copies = 1;                // the term's numbers (weights, bounds) are repeated so often
  Eigen::VectorXd lower, upper;  // bounds of a cone
};

/// (q, v) as the scene's file has them.
Eigen::VectorXd x0_of(const SceneFile& file);

/// Throws std::invalid_argument where the term does not fit.
std::vector<Residual> residuals_of(const TaskTerm& term, const Parts& parts);

void add_cost(const TaskTerm& term, const Parts& parts, CostModelSum& costs);
void add_constraint(const TaskTerm& term, const Parts& parts, ConstraintModelManager& constraints);

}  // namespace manycontact::task
