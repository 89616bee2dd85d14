#pragma once
// Symplectic Euler: with a = a(x, w),
//
//     x' = x (+) [h v + h^2 a; h a].
//
// Crocoddyl's IntegratedActionModelEuler. If the differential model has storage kPanel, no constraints, and controls
// that are constant over a step (PolyZero), the data have no matrices: solvers read those of the differential model.

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
  /// With kPanel, throws std::invalid_argument for constraints, controls that change over a step, user-defined states.
  explicit IntegratedActionDataEuler(IntegratedActionModelEuler* model);

  IntegratorStage stage(std::size_t) const override { return {differential, control}; }
  bool has_matrices() const override { return differential->storage != MatrixStorage::kPanel; }
  void pull_back(const Eigen::VectorXd& p, VectorRef gx, VectorRef gu) const override;
  void dynamics(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const override;
  /// Returns [a_x a_u] of data without matrices. Throws std::logic_error before calcDiff.
  const PanelView& panel() const;
  /// Computes Fx, Fu from lower halves h a_x, h a_u, with calcDiff's J1, J2. Only for states of this library.
  void integrate_velocities(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const;

  std::shared_ptr<DifferentialActionDataAbstract> differential;
  std::shared_ptr<ControlParametrizationDataAbstract> control;
  double step = 0;        // h: set by calcDiff
  Eigen::MatrixXd da_du;  // nv x nu: set by calcDiff
  Eigen::MatrixXd Lwu;    // nw x nu: set by calcDiff

  /// J1, J2 of x (+) dx, which are identities except for joints with several coordinates: set by calcDiff. Let dv'/dx =
  /// [A B] be the lower half of Fx. Then its upper half is J1 [I 0] + h J2 [A B], and that of Fu is h J2 dv'/du.
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
