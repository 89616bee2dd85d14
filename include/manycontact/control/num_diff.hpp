#pragma once

#include "manycontact/action/num_diff.hpp"
#include "manycontact/control/action_model.hpp"

namespace manycontact {

/// A node in discrete time with derivatives by central differences (action/num_diff.hpp).
class ActionModelNumDiff : public NodeNumDiff<ActionModelAbstract, ActionDataAbstract> {
 public:
  /// with_gauss_approx: whether Hessians are Rx^T Rx, ..., as suits costs 1/2 |r|^2, instead of second differences.
  explicit ActionModelNumDiff(std::shared_ptr<ActionModelAbstract> model, bool with_gauss_approx = false);
  std::shared_ptr<ActionDataAbstract> createData() override;
  void set_disturbance(double disturbance);  // throws std::invalid_argument unless it is positive

 private:
  Eigen::VectorXd coordinates(const ActionDataAbstract& at, const ActionDataAbstract& moved, bool) const override {
    return state_->diff_dx(at.xnext, moved.xnext);
  }
};

struct ActionDataNumDiff : NodeDataNumDiff<ActionDataAbstract> {                     // Data of ActionModelNumDiff.
  explicit ActionDataNumDiff(ActionModelNumDiff* model) : NodeDataNumDiff(model) {}  // allocates the data of the model
};

}  // namespace manycontact
