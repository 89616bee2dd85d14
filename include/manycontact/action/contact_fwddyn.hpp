#pragma once
// Contact forward dynamics with costs and constraints: a node of an optimal control problem.
//
//     [ M  J^T     ] [  a ]   [ tau(x, u) - h ]        M mass matrix, h bias torques, a accelerations, f contact forces
//     [ J  -delta I] [ -f ] = [     -a0       ]        J contact Jacobian, a0 its bias, delta = JMinvJt_damping
//
// The interface is that of Crocoddyl's DifferentialActionModelContactFwdDynamics, and of sobec's. The equations are
// solved by dynamics/solve.hpp and differentiated by dynamics/differentiate.hpp.

#include <iosfwd>

#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"
#include "manycontact/action/diff_action.hpp"

namespace manycontact {

struct DifferentialActionDataContactFwdDynamics;
namespace internal {
enum class Stage { kFresh, kRunning, kTerminal };  // kind of the last calc with the data
}

/// A node with contact dynamics, costs and constraints.
class DifferentialActionModelContactFwdDynamics : public DifferentialActionModelAbstract {
 public:
  using ActuationModelAbstract = manycontact::ActuationModelAbstract;
  using Base = DifferentialActionModelAbstract;
  using ConstraintModelManager = manycontact::ConstraintModelManager;
  using ContactModelMultiple = manycontact::ContactModelMultiple;
  using CostModelSum = manycontact::CostModelSum;
  using Data = DifferentialActionDataContactFwdDynamics;
  using crocoContactModelMultiple = manycontact::ContactModelMultiple;  // sobec's name
  using StateMultibody = manycontact::StateMultibody;

  /// enable_force: whether the derivatives of contact forces are always computed, not only if a cost or a constraint
  /// needs them. Throws std::invalid_argument if the parts do not belong together, or the damping is negative.
  DifferentialActionModelContactFwdDynamics(std::shared_ptr<StateMultibody> state,
                                            std::shared_ptr<ActuationModelAbstract> actuation,
                                            std::shared_ptr<ContactModelMultiple> contacts,
                                            std::shared_ptr<CostModelSum> costs, double JMinvJt_damping = 0,
                                            bool enable_force = false)
      : DifferentialActionModelContactFwdDynamics(state, actuation, contacts, costs, nullptr, JMinvJt_damping,
                                                  enable_force) {}
  DifferentialActionModelContactFwdDynamics(std::shared_ptr<StateMultibody> state,
                                            std::shared_ptr<ActuationModelAbstract> actuation,
                                            std::shared_ptr<ContactModelMultiple> contacts,
                                            std::shared_ptr<CostModelSum> costs,
                                            std::shared_ptr<ConstraintModelManager> constraints,
                                            double JMinvJt_damping = 0, bool enable_force = false);

  /// Computes accelerations, forces, costs, constraints; the data's report() has the status. A failed solve gives NaN.
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  /// Computes costs and constraints of a terminal node. Accelerations and forces remain unchanged.
  void calc(const DataPtr& data, const ConstVectorRef& x) override;
  /// Compute the derivatives at the x, u of the last calc; the arguments x, u are ignored. Throw std::logic_error
  /// unless that calc was of the same kind (with or without u) and had the same active costs and constraints.
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) override;
  std::shared_ptr<DifferentialActionDataAbstract> createData() override;
  bool checkData(const DataPtr& data) override;
  /// Computes the u part of the minimum-norm least-squares solution of [dtau/du  J^T] [u; f] = h(q, 0). maxiter and tol
  /// are ignored. The velocity in x must be zero.
  void quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter = 100,
                   double tol = 1e-9) override;
  void print(std::ostream& os) const override;

  const std::shared_ptr<ActuationModelAbstract>& get_actuation() const { return actuation_; }      // the actuation
  const std::shared_ptr<ContactModelMultiple>& get_contacts() const { return contacts_; }          // the contacts
  const std::shared_ptr<CostModelSum>& get_costs() const { return costs_; }                        // the costs
  const std::shared_ptr<ConstraintModelManager>& get_constraints() const { return constraints_; }  // may be null
  const Multibody& get_pinocchio() const { return *multibody_->get_model(); }  // the robots; Crocoddyl's name
  const Multibody& get_model() const { return *multibody_->get_model(); }      // the robots
  /// Returns the armature (nv) [kg m^2, kg]. It replaces the armature of the robots' models, in new and existing data.
  const Eigen::VectorXd& get_armature() const { return armature_; }
  void set_armature(const Eigen::VectorXd& armature);      // throws std::invalid_argument for a wrong size
  double get_damping_factor() const { return damping_; }   // JMinvJt_damping [1/kg]
  void set_damping_factor(double damping);                 // not negative, or std::invalid_argument is thrown
  bool get_enable_force() const { return enable_force_; }  // whether derivatives of forces are always computed
  /// Returns the options of the solves, such as method and order, for data created afterwards.
  const Options& get_options() const { return options_; }
  void set_options(const Options& options) { options_ = options; }  // for data created afterwards
  /// Returns the initial state of motions (nx); an empty vector, the default, specifies none. Some closed mechanisms
  /// have contact rows that depend linearly on others in this state. All solves of data created afterwards treat these
  /// rows as dependent, even if integration errors have slightly opened the mechanism's loop.
  const Eigen::VectorXd& get_start() const { return start_; }
  void set_start(const Eigen::VectorXd& x0);  // throws std::invalid_argument for a wrong size

  /// Returns the external wrenches that act in the solves [N, N m]; initially the wrenches of the state's scene.
  const std::vector<Vec6<double>>& get_wrenches() const { return wrenches_; }
  /// Sets the wrenches in new and existing data: one per wrench of the scene, or std::invalid_argument is thrown.
  void set_wrenches(const std::vector<Vec6<double>>& wrenches);

  std::size_t get_nr() const override { return costs_->get_nr(); }
  std::size_t get_ng() const override { return constraints_ ? constraints_->get_ng() : 0; }
  std::size_t get_nh() const override { return constraints_ ? constraints_->get_nh() : 0; }
  std::size_t get_ng_T() const override { return constraints_ ? constraints_->get_ng_T() : 0; }
  std::size_t get_nh_T() const override { return constraints_ ? constraints_->get_nh_T() : 0; }
  /// Return the bounds of the active constraints. Bounds set by set_g_lb, set_g_ub apply until a constraint is
  /// switched.
  const Eigen::VectorXd& get_g_lb() const override;
  const Eigen::VectorXd& get_g_ub() const override;
  const Eigen::VectorXd& get_g_lb_T() const override { return constraints_ ? constraints_->get_lb_T() : g_lb_; }
  const Eigen::VectorXd& get_g_ub_T() const override { return constraints_ ? constraints_->get_ub_T() : g_ub_; }
  void set_g_lb(const Eigen::VectorXd& g_lb) override;
  void set_g_ub(const Eigen::VectorXd& g_ub) override;

 private:
  friend Data;
  Data& own(const char* where, const DataPtr& data) const;
  Data& refresh(const char* where, const DataPtr& data, const ConstVectorRef& x) const;
  bool needs_forces() const;
  void check_stage(const Data& data, internal::Stage stage) const;
  // Identifies the model in its data. (The address of a deleted model may be reused.) Copies have the same identity.
  std::shared_ptr<const void> identity_ = std::make_shared<char>();
  std::shared_ptr<StateMultibody> multibody_;
  std::shared_ptr<ActuationModelAbstract> actuation_;
  std::shared_ptr<ContactModelMultiple> contacts_;
  std::shared_ptr<CostModelSum> costs_;
  std::shared_ptr<ConstraintModelManager> constraints_;
  Eigen::VectorXd armature_;
  std::shared_ptr<const std::vector<std::shared_ptr<const Model>>> models_;  // the robots' models with armature_
  double damping_;
  bool enable_force_;
  Options options_;
  Eigen::VectorXd start_;
  std::vector<Vec6<double>> wrenches_;
  static constexpr std::size_t kNeverSet = static_cast<std::size_t>(-1);
  /// Value of ConstraintModelManager::get_status when set_g_lb, set_g_ub were called.
  std::size_t g_lb_status_ = kNeverSet, g_ub_status_ = kNeverSet;
};

/// Data of DifferentialActionModelContactFwdDynamics.
struct DifferentialActionDataContactFwdDynamics : DifferentialActionDataAbstract {
  /// Allocates the data of the model.
  explicit DifferentialActionDataContactFwdDynamics(DifferentialActionModelContactFwdDynamics* model);

  std::unique_ptr<DataCollector> multibody;  // scene, solution, torques, contacts
  std::shared_ptr<CostDataSum> costs;
  std::shared_ptr<ConstraintDataManager> constraints;
  /// Returns status, rank and residuals of the last calc(data, x, u).
  const Report& report() const { return multibody->solution.report; }

  // Maintained by the model.
  internal::Stage stage = internal::Stage::kFresh;
  std::shared_ptr<const void> owner;  // the model's identity
  std::size_t contacts_version = 0;
  std::shared_ptr<const std::vector<std::shared_ptr<const Model>>> models;
  Eigen::VectorXd x, u;      // state and controls of the last calc
  std::vector<bool> status;  // whether each cost, then each constraint, was active at the last calc
  bool laid_out = true;      // whether the columns and blocks of derivatives fit the current contact islands
};

}  // namespace manycontact
