#pragma once
// Symplectic Euler with step h, state x = [q; v], controls w and accelerations a = a(x, w):
//
//     x' = x (+) [h v + h^2 a; h a].
//
// The class corresponds to Crocoddyl's IntegratedActionModelEuler. The data have no matrices if the differential model
// has storage kPanel, no constraints, and controls that are constant over a step (PolyZero). Solvers then read the
// differential model's data.

#include "manycontact/control/integrated_action.hpp"

namespace manycontact {

struct IntegratedActionDataEuler;

/// A differential model integrated over one step.
class IntegratedActionModelEuler
    : public NodeWithData<IntegratedActionModelEuler, IntegratedActionModelAbstract, IntegratedActionDataEuler> {
 public:
  static constexpr const char* kName = "IntegratedActionModelEuler";
  using NodeWithData::NodeWithData;  // the constructors of IntegratedActionModelAbstract
  void print(std::ostream& os) const override { print_as(kName, os); }

 private:
  void evaluate(IntegratedActionDataEuler& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void differentiate(IntegratedActionDataEuler& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
};

struct IntegratedActionDataEuler : IntegratedActionDataAbstract {  // Data of IntegratedActionModelEuler.
  /// Throws std::invalid_argument with storage kPanel for constraints, controls that vary in a step, or user-defined
  /// states.
  explicit IntegratedActionDataEuler(IntegratedActionModelEuler* model);

  IntegratorStage stage(std::size_t) const override { return {differential, control}; }
  bool has_matrices() const override { return differential->storage != MatrixStorage::kPanel; }
  void pull_back(const Eigen::VectorXd& p, VectorRef gx, VectorRef gu) const override;
  void dynamics(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const override;
  /// Returns the derivatives [a_x a_u], for data without matrices. Throws std::logic_error before calcDiff.
  const PanelView& panel() const;
  /// Computes fx, fu, whose lower halves contain h a_x, h a_u at entry. Only for states of this library.
  void integrate_velocities(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const;

  std::shared_ptr<DifferentialActionDataAbstract> differential;
  std::shared_ptr<ControlParametrizationDataAbstract> control;
  double step = 0;        // h: set by calcDiff
  Eigen::MatrixXd da_du;  // nv x nu: set by calcDiff
  Eigen::MatrixXd Lwu;    // nw x nu: set by calcDiff

  /// The derivatives J1, J2 of q (+) dq with respect to q and dq, for joints where they are not identities: floating
  /// and planar ones. Set by calcDiff. The upper half of Fx is J1 [I 0] + h J2 [A B], where [A B] = dv'/dx is the lower
  /// half; that of Fu is h J2 dv'/du.
  struct WideJoint {
    int first = 0, size = 0;   // coordinates in v
    Mat6<double> of_x, of_dx;  // J1, J2: size x size
  };
  std::vector<WideJoint> wide_joints;
  bool joints_are_known = false;   // false for state classes that are not part of this library
  Eigen::MatrixXd joint_columns;   // ndx x 6: workspace
  mutable Eigen::VectorXd pulled;  // nv: workspace of pull_back
};

}  // namespace manycontact
