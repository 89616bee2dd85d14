#pragma once
// Contact forward dynamics with costs and constraints: the node of an optimal control problem.
//
//     [ M  J^T     ] [  a ]   [ tau(x, u) - h ]
//     [ J  -delta I] [ -f ] = [     -a0       ]        delta = JMinvJt_damping
//
// Interface of Crocoddyl's DifferentialActionModelContactFwdDynamics and of sobec's; solved and differentiated by
// dynamics/solve.hpp and differentiate.hpp.

#include <iosfwd>

#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"
#include "manycontact/action/diff_action.hpp"

namespace manycontact {

struct DifferentialActionDataContactFwdDynamics;
namespace internal {
enum class Stage { kFresh, kRunning, kTerminal };  // what the last calc on the data was
}

class DifferentialActionModelContactFwdDynamics : public DifferentialActionModelAbstract {  // dynamics and costs
 public:
  using ActuationModelAbstract = manycontact::ActuationModelAbstract;
  using Base = DifferentialActionModelAbstract;
  using ConstraintModelManager = manycontact::ConstraintModelManager;
  using ContactModelMultiple = manycontact::ContactModelMultiple;
  using CostModelSum = manycontact::CostModelSum;
  using Data = DifferentialActionDataContactFwdDynamics;
  using crocoContactModelMultiple = manycontact::ContactModelMultiple;  // by sobec's name
  using StateMultibody = manycontact::StateMultibody;

  /// enable_force: compute the derivatives of the contact forces; they are computed as well when a cost or a constraint
  /// needs them. Throws std::invalid_argument when the parts do not belong together or the damping is negative.
  DifferentialActionModelContactFwdDynamics(std::shared_ptr<StateMultibody> state,
                                            std::shared_ptr<ActuationModelAbstract> actuation,
                                            std::shared_ptr<ContactModelMultiple> contacts,
                                            std::shared_ptr<CostModelSum> costs, double JMinvJt_damping = 0,
                                            bool enable_force = false);
  DifferentialActionModelContactFwdDynamics(std::shared_ptr<StateMultibody> state,
                                            std::shared_ptr<ActuationModelAbstract> actuation,
                                            std::shared_ptr<ContactModelMultiple> contacts,
                                            std::shared_ptr<CostModelSum> costs,
                                            std::shared_ptr<ConstraintModelManager> constraints,
                                            double JMinvJt_damping = 0, bool enable_force = false);

  /// What the answer is worth is in the data's report(); a failed solve leaves NaN.
  void calc(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  /// Touches neither accelerations nor forces.
  void calc(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x) override;
  /// Derivatives at the x, u of the last calc, whatever x, u are given. Throw std::logic_error unless that calc was of
  /// the same kind, with the same costs and constraints active.
  void calcDiff(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x) override;
  std::shared_ptr<DifferentialActionDataAbstract> createData() override;
  bool checkData(const std::shared_ptr<DifferentialActionDataAbstract>& data) override;
  /// The u part of the minimum-norm least-squares solution of [dtau/du  J^T] [u; f] = h(q, 0); maxiter and tol are not
  /// needed. x's velocity must be zero.
  void quasiStatic(const std::shared_ptr<DifferentialActionDataAbstract>& data, VectorRef u, const ConstVectorRef& x,
                   std::size_t maxiter = 100, double tol = 1e-9) override;
  void print(std::ostream& os) const override;

  const std::shared_ptr<ActuationModelAbstract>& get_actuation() const { return actuation_; }
  const std::shared_ptr<ContactModelMultiple>& get_contacts() const { return contacts_; }
  const std::shared_ptr<CostModelSum>& get_costs() const { return costs_; }
  const std::shared_ptr<ConstraintModelManager>& get_constraints() const { return constraints_; }  // may be null
  const Multibody& get_pinocchio() const { return *multibody_->get_model(); }
  const Multibody& get_model() const { return *multibody_->get_model(); }
  /// nv; replaces the model's, for data created from then on as well as for data at hand.
  const Eigen::VectorXd& get_armature() const { return armature_; }
  void set_armature(const Eigen::VectorXd& armature);
  double get_damping_factor() const { return damping_; }
  void set_damping_factor(double damping);
  bool get_enable_force() const { return enable_force_; }
  /// Method and order of the solves, of data created from now on.
  const Options& get_options() const { return options_; }
  void set_options(const Options& options) { options_ = options; }
  /// Where motions start (nx; empty, as at first: anywhere). Contact rows that depend on each other there, as those of
  /// closed mechanisms with more rows than they need, do so in all solves of data created from now on, also where
  /// integration has taken the state off the closed loop by as little as it does.
  const Eigen::VectorXd& get_start() const { return start_; }
  void set_start(const Eigen::VectorXd& x0);

  /// Wrenches of the pushes of the state's scene, which act in the solves [N, N m]; at first the scene's.
  const std::vector<Vec6<double>>& get_pushes() const { return pushes_; }
  /// For data created from then on as well as for data at hand. Throws std::invalid_argument unless there is one per
  /// push.
  void set_pushes(const std::vector<Vec6<double>>& pushes);

  std::size_t get_nr() const override { return costs_->get_nr(); }
  std::size_t get_ng() const override { return constraints_ ? constraints_->get_ng() : 0; }
  std::size_t get_nh() const override { return constraints_ ? constraints_->get_nh() : 0; }
  std::size_t get_ng_T() const override { return constraints_ ? constraints_->get_ng_T() : 0; }
  std::size_t get_nh_T() const override { return constraints_ ? constraints_->get_nh_T() : 0; }
  /// Those of the active constraints; or what set_g_lb, set_g_ub gave, until constraints are added, removed or
  /// switched.
  const Eigen::VectorXd& get_g_lb() const override;
  const Eigen::VectorXd& get_g_ub() const override;
  const Eigen::VectorXd& get_g_lb_T() const override { return constraints_ ? constraints_->get_lb_T() : g_lb_; }
  const Eigen::VectorXd& get_g_ub_T() const override { return constraints_ ? constraints_->get_ub_T() : g_ub_; }
  void set_g_lb(const Eigen::VectorXd& g_lb) override;
  void set_g_ub(const Eigen::VectorXd& g_ub) override;

 private:
  friend Data;
  Data& own(const char* where, const std::shared_ptr<DifferentialActionDataAbstract>& data) const;
  Data& refresh(const char* where, const std::shared_ptr<DifferentialActionDataAbstract>& data,
                const ConstVectorRef& x) const;
  bool needs_forces() const;
  void check_stage(const Data& data, internal::Stage stage) const;
  // Data of a model that is gone must not pass for those of one at its address; a copy, which shares the parts, may use
  // them.
  std::shared_ptr<const void> identity_ = std::make_shared<char>();
  std::shared_ptr<StateMultibody> multibody_;
  std::shared_ptr<ActuationModelAbstract> actuation_;
  std::shared_ptr<ContactModelMultiple> contacts_;
  std::shared_ptr<CostModelSum> costs_;
  std::shared_ptr<ConstraintModelManager> constraints_;
  Eigen::VectorXd armature_;
  std::shared_ptr<const std::vector<std::shared_ptr<const Model>>> models_;  // the robots' models with that armature
  double damping_;
  bool enable_force_;
  Options options_;
  Eigen::VectorXd start_;
  std::vector<Vec6<double>> pushes_;
  static constexpr std::size_t kNeverSet = static_cast<std::size_t>(-1);
  std::size_t g_lb_status_ = kNeverSet, g_ub_status_ = kNeverSet;  // of the constraints, at set_g_lb, set_g_ub
};

struct DifferentialActionDataContactFwdDynamics : DifferentialActionDataAbstract {
  explicit DifferentialActionDataContactFwdDynamics(DifferentialActionModelContactFwdDynamics* model);

  std::unique_ptr<DataCollector> multibody;  // scene, solution, torques, contacts
  std::shared_ptr<CostDataSum> costs;
  std::shared_ptr<ConstraintDataManager> constraints;
  /// Status, rank, residuals of the last calc(data, x, u).
  const Report& report() const { return multibody->solution.report; }

  // Kept by the model.
  internal::Stage stage = internal::Stage::kFresh;
  std::shared_ptr<const void> owner;  // the model's identity
  std::size_t contacts_version = 0;
  std::shared_ptr<const std::vector<std::shared_ptr<const Model>>> models;
  Eigen::VectorXd x, u;      // of the last calc
  std::vector<bool> status;  // of the costs, then of the constraints, at the last calc
  bool laid_out = true;      // columns and blocks fit the islands
};

}  // namespace manycontact
