#pragma once
// The step that simulation/step.hpp takes by semi-implicit Euler, as a node: contacts are held in the velocity, and
// what nothing ties to the world keeps its momentum. From x = (q, v), with the torques tau of its actuation:
//
//     [ M  J^T     ] [  a ]   [ tau - h(q, v)       ]
//     [ J  -delta I] [ -f ] = [ -beta J v - alpha e ]      q+ = q (+) h v+,   v+ = v + h a
//
// and then each free group is given its momentum (simulation/momentum.hpp). Unlike Euler's node (control/euler.hpp) a
// contact answers no J' v: J(q) v+ = (1 - beta h) J(q) v - alpha h e. xnext is what `step` makes of a SimulationData
// that starts at x. A simulation that goes on differs by what the last step left: it goes on from J v at the last q.
//
// Costs and constraints are h times the differential model's, and see its accelerations and forces at x, u, as with all
// other integrators.

#include "manycontact/control/integrated_action.hpp"

namespace manycontact {

namespace internal {
struct HeldVelocities;
}

class IntegratedActionModelSymplectic : public IntegratedActionModelAbstract {  // simulate's default step
 public:
  /// Throw std::invalid_argument where the model is not of contact dynamics (action/contact_fwddyn.hpp).
  IntegratedActionModelSymplectic(std::shared_ptr<DifferentialActionModelAbstract> model,
                                  std::shared_ptr<ControlParametrizationModelAbstract> control, double time_step = 1e-3,
                                  bool with_cost_residual = true);
  explicit IntegratedActionModelSymplectic(std::shared_ptr<DifferentialActionModelAbstract> model,
                                           double time_step = 1e-3, bool with_cost_residual = true);

  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  std::shared_ptr<ActionDataAbstract> createData() override;
  bool checkData(const std::shared_ptr<ActionDataAbstract>& data) override;
  void quasiStatic(const std::shared_ptr<ActionDataAbstract>& data, VectorRef u, const ConstVectorRef& x,
                   std::size_t maxiter = 100, double tol = 1e-9) override;
  void print(std::ostream& os) const override;
};

struct IntegratedActionDataSymplectic : ActionDataAbstract {  // of such a node
  explicit IntegratedActionDataSymplectic(IntegratedActionModelSymplectic* model);
  ~IntegratedActionDataSymplectic() override;

  std::shared_ptr<DifferentialActionDataAbstract> differential;
  std::shared_ptr<ControlParametrizationDataAbstract> control;
  Eigen::VectorXd dx;                              // ndx: the step before momentum is seen to, by calc
  Eigen::MatrixXd F;                               // ndx x (ndx + nw): of xnext, by calcDiff
  Eigen::MatrixXd Lwu;                             // nw x nu: by calcDiff
  std::unique_ptr<internal::HeldVelocities> held;  // a, and what it is worked out in
};

}  // namespace manycontact
