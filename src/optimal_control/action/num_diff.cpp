#include "manycontact/action/num_diff.hpp"

#include "node_num_diff.hpp"

namespace manycontact {

using NumDiff = DifferentialActionModelNumDiff;

template class NodeNumDiff<DifferentialActionModelAbstract, DifferentialActionDataAbstract>;

constexpr const char* kNumDiff = "DifferentialActionModelNumDiff";

void internal::Step::set_disturbance(double disturbance) {
  require(disturbance > 0 && std::isfinite(disturbance), where_,
          std::to_string(disturbance) + " was given, a positive number is expected");
  step_ = disturbance;
}

NumDiff::DifferentialActionModelNumDiff(std::shared_ptr<DifferentialActionModelAbstract> model, bool with_gauss_approx)
    : NodeNumDiff(kNumDiff, std::move(model), with_gauss_approx, &DifferentialActionDataAbstract::xout,
                  "DifferentialActionModelNumDiff::set_disturbance") {}

std::shared_ptr<DifferentialActionDataAbstract> NumDiff::createData() {
  return std::make_shared<DifferentialActionDataNumDiff>(this);
}

std::string NumDiff::where(const char*) const { return kNumDiff; }

Eigen::VectorXd NumDiff::coordinates(const DifferentialActionDataAbstract&, const DifferentialActionDataAbstract& moved,
                                     bool terminal) const {
  return terminal ? Eigen::VectorXd::Zero(state_->get_nv()).eval() : moved.xout;  // a terminal node does not accelerate
}

}  // namespace manycontact
