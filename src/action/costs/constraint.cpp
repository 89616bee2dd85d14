#include "manycontact/action/constraint.hpp"

#include <ostream>

namespace manycontact {

ConstraintModelResidual::ConstraintModelResidual(std::shared_ptr<StateMultibody> state,
                                                 std::shared_ptr<ResidualModelAbstract> residual,
                                                 const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, bool T_act)
    : state_(std::move(state)), residual_(std::move(residual)), lb_(lower), ub_(upper) {
  constexpr const char* kWho = "ConstraintModelResidual";
  require(state_ && residual_, kWho, "a null pointer was given, a state and a residual are expected");
  require(residual_->get_state() == state_, kWho, "the residual belongs to another state, this one's is expected");
  check_size(kWho, "the lower bound", lower.size(), residual_->get_nr());
  check_size(kWho, "the upper bound", upper.size(), residual_->get_nr());
  for (int i = 0; i < lower.size(); ++i) {
    require(lower[i] <= upper[i], kWho,
            "bound " + std::to_string(i) + " has lower " + std::to_string(lower[i]) + ", upper " +
                std::to_string(upper[i]) + "; lower <= upper is expected");
    (lower[i] == upper[i] ? equalities_ : inequalities_).push_back(i);
  }
  T_ = T_act && !residual_->get_u_dependent();
}

ConstraintModelResidual::ConstraintModelResidual(std::shared_ptr<StateMultibody> state,
                                                 std::shared_ptr<ResidualModelAbstract> residual, bool T_act)
    : ConstraintModelResidual(state, residual, Eigen::VectorXd::Zero(residual ? residual->get_nr() : 0),
                              Eigen::VectorXd::Zero(residual ? residual->get_nr() : 0), T_act) {}

void ConstraintModelResidual::print(std::ostream& os) const {
  os << "ConstraintModelResidual {" << *residual_ << ", ng=" << get_ng() << ", nh=" << get_nh() << "}";
}

std::ostream& operator<<(std::ostream& os, const ConstraintModelResidual& model) {
  model.print(os);
  return os;
}

}  // namespace manycontact
