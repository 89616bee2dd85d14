#pragma once
// Functions for the "terms" of action models with contacts, which are named costs and constraints that can be inactive.

#include "manycontact/action/contact_fwddyn.hpp"

namespace manycontact::internal {

struct ActionTerms {  // The terms of an action model. constraints is null if there are none.
  const CostModelSum& costs;
  const ConstraintModelManager* constraints;
};

/// Calls use(name, residual, active) for each cost, then for each constraint.
template <class Use>
void each_residual(const ActionTerms& terms, Use&& use) {
  for (const auto& [name, item] : terms.costs.get_costs()) use(name, *item->cost->get_residual(), item->active);
  if (!terms.constraints) return;
  for (const auto& [name, item] : terms.constraints->get_constraints())
    use(name, *item->constraint->get_residual(), item->active);
}

/// Throws std::invalid_argument if costs or constraints were added or removed since the data were created, or if the
/// `active` of a constraint was changed without changeConstraintStatus.
void check_terms(const char* where, const ActionTerms& terms, const CostDataSum& costs,
                 const ConstraintDataManager* constraints);
/// Returns whether ResidualModelAbstract::fits is true for the data of all residuals; false after a frame has changed.
bool residuals_fit(const ActionTerms& terms, const CostDataSum& costs, const ConstraintDataManager* constraints);
/// read_status stores whether each term is active, in the order of each_residual. has_status compares this to `status`.
void read_status(const ActionTerms& terms, std::vector<bool>& status);
bool has_status(const ActionTerms& terms, const std::vector<bool>& status);
/// Throws std::logic_error unless `fits`. The message asks for a calc of this stage with the same active terms.
void check_stage(const char* who, bool fits, Stage stage);
void stack_residuals(const CostModelSum& model, const CostDataSum& data, Eigen::VectorXd& r);

}  // namespace manycontact::internal
