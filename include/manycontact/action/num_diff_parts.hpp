#pragma once
// Numerical twins of an action model's parts: derivatives by central differences, for users' own parts, and for tests.
// By Crocoddyl's names. The step is absolute on tangents, relative to max(1, |u_i|) in u. Parts evaluated by hand see
// more than x and u: set_reevals takes what brings that up to date, called with each x, u before the part's calc, and
// at last with the point itself.

#include <cmath>
#include <functional>
#include <limits>

#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"

namespace manycontact {

namespace internal {

/// The step of a twin.
class Step {
 public:
  double get_disturbance() const { return step_; }
  /// Throws std::invalid_argument unless it is positive.
  void set_disturbance(double disturbance);

 protected:
  double step_ = std::cbrt(std::numeric_limits<double>::epsilon());
};

/// What a twin by hand calls before its part.
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

/// Jdiff, Jintegrate and JintegrateTransport of any state; the rest is the state's own.
class StateNumDiff : public StateAbstract, public internal::Step {
 public:
  explicit StateNumDiff(std::shared_ptr<StateAbstract> state);
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

/// Ar, and of the Hessian the diagonal.
class ActivationModelNumDiff : public ActivationModelAbstract, public internal::Step {
 public:
  explicit ActivationModelNumDiff(std::shared_ptr<ActivationModelAbstract> model);
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  std::shared_ptr<ActivationDataAbstract> createData() override;
  const std::shared_ptr<ActivationModelAbstract>& get_model() const { return model_; }

 private:
  std::shared_ptr<ActivationModelAbstract> model_;
};

/// Of the twin.
struct ActivationDataNumDiff : ActivationDataAbstract {
  explicit ActivationDataNumDiff(const ActivationModelNumDiff* model);
  std::shared_ptr<ActivationDataAbstract> data_0;
  Eigen::MatrixXd Arr_;  // nr x nr: the whole Hessian
};

/// dtau_dx, dtau_du; Mtau is the pseudo-inverse of dtau_du, of whose singular values those within the differences'
/// accuracy are zero.
class ActuationModelNumDiff : public ActuationModelAbstract, public internal::Step {
 public:
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
  const std::shared_ptr<ActuationModelAbstract>& get_model() const { return model_; }

 private:
  std::shared_ptr<ActuationModelAbstract> model_;
};

/// Of the twin.
struct ActuationDataNumDiff : ActuationDataAbstract {
  explicit ActuationDataNumDiff(const ActuationModelNumDiff* model);
  std::shared_ptr<ActuationDataAbstract> data_0;
};

/// Rx, Ru.
class ResidualModelNumDiff : public ResidualModelAbstract, public internal::Step, public internal::Reevaluation {
 public:
  explicit ResidualModelNumDiff(const std::shared_ptr<ResidualModelAbstract>& model);
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x) override;
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x) override;
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  const std::shared_ptr<ResidualModelAbstract>& get_model() const { return model_; }

 private:
  std::shared_ptr<ResidualModelAbstract> model_;
};

/// Of the twin.
struct ResidualDataNumDiff : ResidualDataAbstract {
  ResidualDataNumDiff(const ResidualModelNumDiff* model, DataCollector* shared);
  std::shared_ptr<ResidualDataAbstract> data_0;
};

/// Lx, Lu; Hessians of Gauss-Newton, by the residual's differences.
class CostModelNumDiff : public internal::Step, public internal::Reevaluation {
 public:
  explicit CostModelNumDiff(const std::shared_ptr<CostModelAbstract>& model);
  void calc(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calc(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x);
  void calcDiff(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calcDiff(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x);
  /// Data by hand.
  std::shared_ptr<CostDataAbstract> createData(DataCollector* shared);
  const std::shared_ptr<CostModelAbstract>& get_model() const { return model_; }
  const std::shared_ptr<StateAbstract>& get_state() const { return model_->get_state(); }
  std::size_t get_nu() const { return model_->get_nu(); }
  bool get_with_gauss_approx() const { return true; }

 private:
  template <class Calc>
  void differentiate(CostDataAbstract& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u, bool terminal,
                     Calc&& calc);
  std::shared_ptr<CostModelAbstract> model_;
};

/// Gx, Gu, Hx, Hu.
class ConstraintModelNumDiff : public internal::Step, public internal::Reevaluation {
 public:
  explicit ConstraintModelNumDiff(const std::shared_ptr<ConstraintModelAbstract>& model);
  void calc(const std::shared_ptr<ConstraintDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calc(const std::shared_ptr<ConstraintDataAbstract>& data, const ConstVectorRef& x);
  void calcDiff(const std::shared_ptr<ConstraintDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calcDiff(const std::shared_ptr<ConstraintDataAbstract>& data, const ConstVectorRef& x);
  std::shared_ptr<ConstraintDataAbstract> createData(DataCollector* shared);
  const std::shared_ptr<ConstraintModelAbstract>& get_model() const { return model_; }
  const std::shared_ptr<StateAbstract>& get_state() const { return model_->get_state(); }
  std::size_t get_nu() const { return model_->get_nu(); }

 private:
  template <class Calc>
  void differentiate(ConstraintDataAbstract& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u, bool terminal,
                     Calc&& calc);
  std::shared_ptr<ConstraintModelAbstract> model_;
};

/// da0_dx, at the motion that reevals leave.
class ContactModelNumDiff : public internal::Step, public internal::Reevaluation {
 public:
  explicit ContactModelNumDiff(const std::shared_ptr<ContactModelAbstract>& model);
  void calc(const std::shared_ptr<ContactDataAbstract>& data, const ConstVectorRef& x);
  void calcDiff(const std::shared_ptr<ContactDataAbstract>& data, const ConstVectorRef& x);
  std::shared_ptr<ContactDataAbstract> createData(MultibodyData* data);
  const std::shared_ptr<ContactModelAbstract>& get_model() const { return model_; }

 private:
  std::shared_ptr<ContactModelAbstract> model_;
};

}  // namespace manycontact
