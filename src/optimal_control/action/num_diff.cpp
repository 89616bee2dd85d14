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

Eigen::VectorXd NumDiff::change(const DifferentialActionDataAbstract&, const Eigen::VectorXd& plus,
                                const Eigen::VectorXd& minus, bool terminal) const {
  if (terminal) return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(state_->get_nv()));  // it has no acceleration
  return plus - minus;
}

}  // namespace manycontact
