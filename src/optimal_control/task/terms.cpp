#include "terms.hpp"

#include <cmath>

#include "manycontact/task/rows.hpp"

namespace manycontact::task {

namespace {

Eigen::VectorXd repeated(const Eigen::VectorXd& x, int copies) { return x.replicate(copies, 1); }

Eigen::VectorXd lower_of(const TaskTerm& term, const Residual& r) {
  return term.lower.size() > 0 ? repeated(term.lower, r.copies) : r.lower;
}
Eigen::VectorXd upper_of(const TaskTerm& term, const Residual& r) {
  return term.upper.size() > 0 ? repeated(term.upper, r.copies) : r.upper;
}

std::shared_ptr<ActivationModelAbstract> activation_of(const TaskTerm& term, const Residual& r) {
  switch (term.activation) {
    case TaskActivation::kQuad:
      return std::make_shared<ActivationModelQuad>(r.model->get_nr());
    case TaskActivation::kWeightedQuad:
      return std::make_shared<ActivationModelWeightedQuad>(repeated(term.weights, r.copies));
    case TaskActivation::kSmooth1Norm:
      return std::make_shared<ActivationModelSmooth1Norm>(r.model->get_nr(), term.eps);
    case TaskActivation::kQuadraticBarrier:
      return std::make_shared<ActivationModelQuadraticBarrier>(ActivationBounds(lower_of(term, r), upper_of(term, r)));
    case TaskActivation::kWeightedQuadraticBarrier:
      return std::make_shared<ActivationModelWeightedQuadraticBarrier>(
          ActivationBounds(lower_of(term, r), upper_of(term, r)), repeated(term.weights, r.copies));
  }
  return nullptr;
}

}  // namespace

void add_cost(const TaskTerm& term, const Parts& p, CostModelSum& costs) {
  for (const Residual& r : residuals_of(term, p))
    costs.addCost(r.name, std::make_shared<CostModelResidual>(p.state, activation_of(term, r), r.model), term.weight);
}

// Rows without a finite bound are left out.
void add_constraint(const TaskTerm& term, const Parts& p, ConstraintModelManager& constraints) {
  for (Residual& r : residuals_of(term, p)) {
    const Eigen::VectorXd lower = lower_of(term, r), upper = upper_of(term, r);
    std::vector<int> bounded;
    for (Eigen::Index i = 0; i < lower.size(); ++i)
      if (std::isfinite(lower[i]) || std::isfinite(upper[i])) bounded.push_back(static_cast<int>(i));
    if (bounded.empty()) continue;
    const bool all = static_cast<Eigen::Index>(bounded.size()) == lower.size();
    const std::shared_ptr<ResidualModelAbstract> model =
        all ? r.model : std::make_shared<ResidualModelRows>(r.model, bounded);
    constraints.addConstraint(
        r.name, std::make_shared<ConstraintModelResidual>(p.state, model, lower(bounded), upper(bounded)));
  }
}

}  // namespace manycontact::task
