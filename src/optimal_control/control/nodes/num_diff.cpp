#include "manycontact/control/num_diff.hpp"

#include "../../action/node_num_diff.hpp"

namespace manycontact {

template class NodeNumDiff<ActionModelAbstract, ActionDataAbstract>;

constexpr const char* kNumDiffSetDisturbance = "ActionModelNumDiff::set_disturbance";

ActionModelNumDiff::ActionModelNumDiff(std::shared_ptr<ActionModelAbstract> model, bool with_gauss_approx)
    : NodeNumDiff("ActionModelNumDiff", std::move(model), with_gauss_approx, &ActionDataAbstract::xnext,
                  kNumDiffSetDisturbance) {}

void ActionModelNumDiff::set_disturbance(double disturbance) {
  require(disturbance > 0 && std::isfinite(disturbance), kNumDiffSetDisturbance, "a positive number is expected");
  step_ = disturbance;
}

std::shared_ptr<ActionDataAbstract> ActionModelNumDiff::createData() {
  return std::make_shared<ActionDataNumDiff>(this);
}

}  // namespace manycontact
