#pragma once
// Parts of an action model whose derivatives are central differences of another part. They are meant for user-defined
// parts, and for tests; the names are Crocoddyl's. The step is absolute on tangent spaces, relative to max(1, |u_i|) in
// u. Standalone parts depend on more than x and u: set_reevals takes functions that update these data. They are called
// with each x, u before the part's calc, and finally at the point itself.

#include <cmath>
#include <functional>
#include <limits>

#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"

namespace manycontact {

namespace internal {

/// The step of the differences.
class Step {
 public:
  double get_disturbance() const { return step_; }
  /// Throws std::invalid_argument unless it is positive.
  void set_disturbance(double disturbance);

 protected:
  double step_ = std::cbrt(std::numeric_limits<double>::epsilon());
};

/// The functions that are called before a standalone part is evaluated.
class Reevaluation {
 public:
  using ReevaluationFunction = std::function<void(const Eigen::VectorXd& x, const Eigen::VectorXd& u)>;
  void set_reevals(const std::vector<ReevaluationFunction>& reevals) { reevals_ = reevals; }

 protected:
  void reevaluate(const Eigen::VectorXd& x, const Eigen::VectorXd& u) const {
    for (const ReevaluationFunction& reevaluate : reevals_) reevaluate(x, u);
  }
  std::vector<ReevaluationFunction> reevals_;
};

}  // namespace internal

/// Differentiates Jdiff, Jintegrate and JintegrateTransport of any state; everything else is the state's own.
class StateNumDiff : public StateAbstract, public internal::Step {
 public:
  explicit StateNumDiff(std::shared_ptr<StateAbstract> state);  // state: the one that is differentiated
  Eigen::VectorXd zero() const override { return state_model_->zero(); }
  Eigen::VectorXd rand() const override { return state_model_->rand(); }
  void diff(const ConstVectorRef& x0, const ConstVectorRef& x1, VectorRef dxout) const override;
  void integrate(const ConstVectorRef& x, const ConstVectorRef& dx, VectorRef xout) const override;
  void Jdiff(const ConstVectorRef& x0, const ConstVectorRef& x1, MatrixRef Jfirst, MatrixRef Jsecond,
             Jcomponent firstsecond = both) const override;
  void Jintegrate(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jfirst, MatrixRef Jsecond,
                  Jcomponent firstsecond = both, AssignmentOp op = setto) const override;
  void JintegrateTransport(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jin,
                           Jcomponent firstsecond) const override;

 private:
  std::shared_ptr<StateAbstract> state_model_;
};

/// Differentiates an activation: Ar, and the diagonal of the Hessian.
class ActivationModelNumDiff : public ActivationModelAbstract, public internal::Step {
 public:
  /// model: the one that is differentiated.
  explicit ActivationModelNumDiff(std::shared_ptr<ActivationModelAbstract> model);
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  std::shared_ptr<ActivationDataAbstract> createData() override;
  /// The model that is differentiated.
  const std::shared_ptr<ActivationModelAbstract>& get_model() const { return model_; }

 private:
  std::shared_ptr<ActivationModelAbstract> model_;
};

/// Data of ActivationModelNumDiff.
struct ActivationDataNumDiff : ActivationDataAbstract {
  explicit ActivationDataNumDiff(const ActivationModelNumDiff* model);  // allocates the data of the model
  std::shared_ptr<ActivationDataAbstract> data_0;
  Eigen::MatrixXd Arr_;  // nr x nr: the whole Hessian
};

/// Differentiates an actuation: dtau_dx, dtau_du. Mtau is the pseudoinverse of dtau_du; singular values within the
/// accuracy of the differences are zero.
class ActuationModelNumDiff : public ActuationModelAbstract, public internal::Step {
 public:
  /// model: the one that is differentiated.
  explicit ActuationModelNumDiff(std::shared_ptr<ActuationModelAbstract> model);
  void calc(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x) override;
  void calcDiff(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x) override;
  void commands(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& tau) override;
  void torqueTransform(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                       const ConstVectorRef& u) override;
  std::shared_ptr<ActuationDataAbstract> createData() override;
  /// The model that is differentiated.
  const std::shared_ptr<ActuationModelAbstract>& get_model() const { return model_; }

 private:
  std::shared_ptr<ActuationModelAbstract> model_;
};

/// Data of ActuationModelNumDiff.
struct ActuationDataNumDiff : ActuationDataAbstract {
  explicit ActuationDataNumDiff(const ActuationModelNumDiff* model);  // allocates the data of the model
  std::shared_ptr<ActuationDataAbstract> data_0;
};

/// Differentiates a residual: Rx, Ru.
class ResidualModelNumDiff : public ResidualModelAbstract, public internal::Step, public internal::Reevaluation {
 public:
  /// model: the one that is differentiated.
  explicit ResidualModelNumDiff(const std::shared_ptr<ResidualModelAbstract>& model);
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x) override;
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x) override;
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  /// The model that is differentiated.
  const std::shared_ptr<ResidualModelAbstract>& get_model() const { return model_; }

 private:
  std::shared_ptr<ResidualModelAbstract> model_;
};

/// Data of ResidualModelNumDiff.
struct ResidualDataNumDiff : ResidualDataAbstract {
  ResidualDataNumDiff(const ResidualModelNumDiff* model, DataCollector* shared);  // allocates the data of the model
  std::shared_ptr<ResidualDataAbstract> data_0;
};

/// Differentiates a cost: Lx, Lu. Hessians are Gauss-Newton's, with differences of the residual.
class CostModelNumDiff : public internal::Step, public internal::Reevaluation {
 public:
  explicit CostModelNumDiff(const std::shared_ptr<CostModelAbstract>& model);  // model: the one that is differentiated
  /// Evaluates the model.
  void calc(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calc(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x);  // evaluates the model
  /// Computes the derivatives by central differences.
  void calcDiff(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  /// Computes the derivatives by central differences.
  void calcDiff(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x);
  /// Creates standalone data.
  std::shared_ptr<CostDataAbstract> createData(DataCollector* shared);
  const std::shared_ptr<CostModelAbstract>& get_model() const { return model_; }  // the model that is differentiated
  /// The state that it was made for.
  const std::shared_ptr<StateAbstract>& get_state() const { return model_->get_state(); }
  std::size_t get_nu() const { return model_->get_nu(); }  // number of controls
  bool get_with_gauss_approx() const { return true; }      // whether Hessians are Gauss-Newton's

 private:
  template <class Calc>
  void differentiate(CostDataAbstract& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u, bool terminal,
                     Calc&& calc);
  std::shared_ptr<CostModelAbstract> model_;
};

/// Differentiates a constraint: Gx, Gu, Hx, Hu.
class ConstraintModelNumDiff : public internal::Step, public internal::Reevaluation {
 public:
  /// model: the one that is differentiated.
  explicit ConstraintModelNumDiff(const std::shared_ptr<ConstraintModelAbstract>& model);
  /// Evaluates the model.
  void calc(const std::shared_ptr<ConstraintDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calc(const std::shared_ptr<ConstraintDataAbstract>& data, const ConstVectorRef& x);  // evaluates the model
  /// Computes the derivatives by central differences.
  void calcDiff(const std::shared_ptr<ConstraintDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  /// Computes the derivatives by central differences.
  void calcDiff(const std::shared_ptr<ConstraintDataAbstract>& data, const ConstVectorRef& x);
  /// Creates data of this model; one per thread.
  std::shared_ptr<ConstraintDataAbstract> createData(DataCollector* shared);
  /// The model that is differentiated.
  const std::shared_ptr<ConstraintModelAbstract>& get_model() const { return model_; }
  /// The state that it was made for.
  const std::shared_ptr<StateAbstract>& get_state() const { return model_->get_state(); }
  std::size_t get_nu() const { return model_->get_nu(); }  // number of controls

 private:
  template <class Calc>
  void differentiate(ConstraintDataAbstract& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u, bool terminal,
                     Calc&& calc);
  std::shared_ptr<ConstraintModelAbstract> model_;
};

/// Differentiates a contact: da0_dx, at the motion that the reevaluations compute.
class ContactModelNumDiff : public internal::Step, public internal::Reevaluation {
 public:
  /// model: the one that is differentiated.
  explicit ContactModelNumDiff(const std::shared_ptr<ContactModelAbstract>& model);
  void calc(const std::shared_ptr<ContactDataAbstract>& data, const ConstVectorRef& x);  // evaluates the model
  /// Computes the derivatives by central differences.
  void calcDiff(const std::shared_ptr<ContactDataAbstract>& data, const ConstVectorRef& x);
  std::shared_ptr<ContactDataAbstract> createData(MultibodyData* data);  // creates data of this model; one per thread
  const std::shared_ptr<ContactModelAbstract>& get_model() const { return model_; }  // the model that is differentiated

 private:
  std::shared_ptr<ContactModelAbstract> model_;
};

}  // namespace manycontact
