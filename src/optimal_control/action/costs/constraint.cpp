#include "manycontact/action/constraint.hpp"

#include <ostream>

namespace manycontact {

ConstraintModelResidual::ConstraintModelResidual(std::shared_ptr<StateAbstract> state,
                                                 std::shared_ptr<ResidualModelAbstract> residual,
                                                 const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, bool T_act)
    : state_(std::move(state)), residual_(std::move(residual)), lb_(lower), ub_(upper) {
  constexpr const char* kWho = "ConstraintModelResidual";
  require(state_ && residual_, kWho, "a null pointer was given, a state and a residual are expected");
  require(same_space(*residual_->get_state(), *state_), kWho,
          "the residual belongs to another state, this one's is expected");
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

ConstraintModelResidual::ConstraintModelResidual(std::shared_ptr<StateAbstract> state,
                                                 std::shared_ptr<ResidualModelAbstract> residual, bool T_act)
    : ConstraintModelResidual(state, residual, Eigen::VectorXd::Zero(residual ? residual->get_nr() : 0),
                              Eigen::VectorXd::Zero(residual ? residual->get_nr() : 0), T_act) {}

ConstraintDataResidual::ConstraintDataResidual(ConstraintModelResidual* model, DataCollector* s)
    : shared(s), residual(model->get_residual()->createData(s)) {
  const auto ng = static_cast<Eigen::Index>(model->get_ng()), nh = static_cast<Eigen::Index>(model->get_nh());
  const auto ndx = static_cast<Eigen::Index>(model->get_state()->get_ndx());
  const auto nu = static_cast<Eigen::Index>(model->get_nu());
  g.setZero(ng), h.setZero(nh);
  Gx.setZero(ng, ndx), Gu.setZero(ng, nu);
  Hx.setZero(nh, ndx), Hu.setZero(nh, nu);
}

std::shared_ptr<ConstraintDataResidual> ConstraintModelResidual::createData(DataCollector* shared) {
  return std::make_shared<ConstraintDataResidual>(this, shared);
}

// g = r, h = r - lb.
void ConstraintModelResidual::pick_values(ConstraintDataResidual& data) const {
  data.g = data.residual->r(inequalities_);
  data.h = data.residual->r(equalities_) - lb_(equalities_);
}

void ConstraintModelResidual::pick_jacobians(ConstraintDataResidual& data) const {
  residual_->take_whole(*data.residual);
  const Eigen::MatrixXd Rx = data.residual->whole_Rx(), Ru = data.residual->whole_Ru();
  data.Gx = Rx(inequalities_, Eigen::all);
  data.Gu = Ru(inequalities_, Eigen::all);
  data.Hx = Rx(equalities_, Eigen::all);
  data.Hu = Ru(equalities_, Eigen::all);
}

void ConstraintModelResidual::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  residual_->calc(check_data("ConstraintModelResidual::calc", data).residual, x, u);
  pick_values(*data);
}

void ConstraintModelResidual::calc(const DataPtr& data, const ConstVectorRef& x) {
  residual_->calc(check_data("ConstraintModelResidual::calc", data).residual, x);
  pick_values(*data);
}

void ConstraintModelResidual::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  residual_->calcDiff(check_data("ConstraintModelResidual::calcDiff", data).residual, x, u);
  pick_jacobians(*data);
}

void ConstraintModelResidual::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  residual_->calcDiff(check_data("ConstraintModelResidual::calcDiff", data).residual, x);
  pick_jacobians(*data);
}

void ConstraintModelResidual::print(std::ostream& os) const {
  os << "ConstraintModelResidual {" << *residual_ << ", ng=" << get_ng() << ", nh=" << get_nh() << "}";
}

}  // namespace manycontact
