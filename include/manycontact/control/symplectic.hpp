#pragma once
// The step of semi-implicit Euler in simulation/step.hpp, as a node: contacts constrain the velocity, and bodies
// without connection to the world keep their momentum. At x = (q, v), with torques tau, contact errors e, step h:
//
//     [ M  J^T     ] [  a ]   [ tau - h(q, v)       ]
//     [ J  -delta I] [ -f ] = [ -beta J v - alpha e ]      q+ = q (+) h v+,   v+ = v + h a
//
// Then the momentum of each free group is corrected (detail/simulation/momentum.hpp). Unlike control/euler.hpp, this
// step omits the bias J' v: J(q) v+ = (1 - beta h) J(q) v - alpha h e. The next state equals the first `step` of a
// SimulationData that starts at x. Later steps of a simulation differ, because they use J v at the previous q.
//
// The cost is h times that of the differential model. Cost and constraints use the accelerations and forces of the
// differential model at x, u.

#include "manycontact/control/integrated_action.hpp"

namespace manycontact {

namespace internal {
struct HeldVelocities;
}

struct IntegratedActionDataSymplectic;

/// A node with the default step of a simulation.
class IntegratedActionModelSymplectic
    : public NodeWithData<IntegratedActionModelSymplectic, IntegratedActionModelAbstract,
                          IntegratedActionDataSymplectic> {
 public:
  static constexpr const char* kName = "IntegratedActionModelSymplectic";  // for messages

  /// Throw std::invalid_argument unless the model is one of contact dynamics (action/contact_fwddyn.hpp).
  IntegratedActionModelSymplectic(std::shared_ptr<DifferentialActionModelAbstract> model,
                                  std::shared_ptr<ControlParametrizationModelAbstract> control, double time_step = 1e-3,
                                  bool with_cost_residual = true);
  explicit IntegratedActionModelSymplectic(std::shared_ptr<DifferentialActionModelAbstract> model,
                                           double time_step = 1e-3,
                                           bool with_cost_residual = true);  // with constant controls
  void print(std::ostream& os) const override { print_as(kName, os); }

 private:
  void evaluate(IntegratedActionDataSymplectic& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void differentiate(IntegratedActionDataSymplectic& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
};

struct IntegratedActionDataSymplectic : IntegratedActionDataAbstract {  // Data of IntegratedActionModelSymplectic.
  explicit IntegratedActionDataSymplectic(IntegratedActionModelSymplectic* model);  // allocates the data of the model
  ~IntegratedActionDataSymplectic() override;
  IntegratorStage stage(std::size_t) const override { return {differential, control}; }

  std::shared_ptr<DifferentialActionDataAbstract> differential;
  std::shared_ptr<ControlParametrizationDataAbstract> control;
  Eigen::MatrixXd F;                               // ndx x (ndx + nw): derivatives of xnext, set by calcDiff
  Eigen::MatrixXd Lwu;                             // nw x nu: set by calcDiff
  std::unique_ptr<internal::HeldVelocities> held;  // the accelerations of this step, and their workspace
};

}  // namespace manycontact
