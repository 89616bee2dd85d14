#pragma once
// Symplectic Euler: with a = a(x, w),
//
//     x' = x (+) [h v + h^2 a; h a].
//
// Crocoddyl's IntegratedActionModelEuler. Of a differential model with storage kPanel, which has no constraints and
// whose controls are constant over a step (PolyZero), the data have no matrices: solvers read the differential model's.

#include "manycontact/control/integrated_action.hpp"

namespace manycontact {

class IntegratedActionModelEuler : public IntegratedActionModelAbstract {  // a differential model over one step
 public:
  using IntegratedActionModelAbstract::IntegratedActionModelAbstract;

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

struct IntegratedActionDataEuler : ActionDataAbstract {  // of such a node
  /// Throws std::invalid_argument for storage kPanel with constraints, other controls, or a state of another kind than
  /// this library's.
  explicit IntegratedActionDataEuler(IntegratedActionModelEuler* model);

  bool has_matrices() const override { return differential->storage != MatrixStorage::kPanel; }
  void pull_back(const Eigen::VectorXd& p, VectorRef gx, VectorRef gu) const override;
  void dynamics(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const override;
  /// [a_x a_u] where there are no matrices. Throws std::logic_error before calcDiff.
  const PanelView& panel() const;
  /// Fx, Fu where their lower halves are h a_x, h a_u: by calcDiff's J1, J2. Of joints that are known.
  void integrate_velocities(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const;

  std::shared_ptr<DifferentialActionDataAbstract> differential;
  std::shared_ptr<ControlParametrizationDataAbstract> control;
  Eigen::VectorXd dx;     // ndx: the step, by calc
  double step = 0;        // h: by calcDiff
  Eigen::MatrixXd da_du;  // nv x nu: by calcDiff
  Eigen::MatrixXd Lwu;    // nw x nu: by calcDiff

  /// J1, J2 of x (+) dx, which are identities but for joints of several coordinates: by calcDiff. With them and
  /// dv'/dx = [A B], the lower half of Fx, the upper half is J1 [I 0] + h J2 [A B]; that of Fu is h J2 dv'/du.
  struct WideJoint {
    int first = 0, size = 0;   // coordinates in v
    Mat6<double> of_x, of_dx;  // J1, J2: size x size
  };
  std::vector<WideJoint> wide_joints;
  bool joints_are_known = false;   // false for states of other kinds than this library's
  Eigen::MatrixXd joint_columns;   // ndx x 6: workspace
  mutable Eigen::VectorXd pulled;  // nv: workspace of pull_back
};

}  // namespace manycontact
