#pragma once
// Parts of an action model whose derivatives are central differences of another part, for user-defined parts and for
// tests. The names are those of Crocoddyl. The step is absolute on tangent spaces, and relative to max(1, |u_i|) in u.
// Standalone parts depend on more than x and u: set_reevals takes functions that update these further data. The
// functions are called with each x, u before the part's calc, and finally at the point where derivatives are computed.

#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"
#include "manycontact/action/num_diff.hpp"

namespace manycontact {

/// Differentiates Jdiff, Jintegrate and JintegrateTransport of any state by differences; all other functions are those
/// of the state.
class StateNumDiff : public StateAbstract, public internal::Step {
 public:
  explicit StateNumDiff(std::shared_ptr<StateAbstract> state);  // state: the state to differentiate
  Eigen::VectorXd zero() const override { return state_model_->zero(); }
  Eigen::VectorXd rand() const override { return state_model_->rand(); }
  void diff(const ConstVectorRef& x0, const ConstVectorRef& x1, VectorRef dxout) const override {
    state_model_->diff(x0, x1, dxout);
  }
  void integrate(const ConstVectorRef& x, const ConstVectorRef& dx, VectorRef xout) const override {
    state_model_->integrate(x, dx, xout);
  }
  void Jdiff(const ConstVectorRef& x0, const ConstVectorRef& x1, MatrixRef Jfirst, MatrixRef Jsecond,
             Jcomponent firstsecond = both) const override;
  void Jintegrate(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jfirst, MatrixRef Jsecond,
                  Jcomponent firstsecond = both, AssignmentOp op = setto) const override;
  void JintegrateTransport(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jin,
                           Jcomponent firstsecond) const override;

 private:
  std::shared_ptr<StateAbstract> state_model_;
};

/// Differentiates an activation by differences: Ar, and the diagonal of the Hessian.
class ActivationModelNumDiff : public ActivationModelAbstract, public NumDiffOf<ActivationModelAbstract> {
 public:
  /// model: the activation to differentiate.
  explicit ActivationModelNumDiff(std::shared_ptr<ActivationModelAbstract> model)
      : ActivationModelAbstract(internal::given("ActivationModelNumDiff", model)->get_nr()),
        NumDiffOf("ActivationModelNumDiff", model) {}
  void calc(const DataPtr& data, const ConstVectorRef& r) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& r) override;
  std::shared_ptr<ActivationDataAbstract> createData() override;
};

/// Data of ActivationModelNumDiff.
struct ActivationDataNumDiff : ActivationDataAbstract {
  explicit ActivationDataNumDiff(const ActivationModelNumDiff* model);  // allocates the data
  std::shared_ptr<ActivationDataAbstract> data_0;
  Eigen::MatrixXd Arr_;  // nr x nr: the whole Hessian
};

/// Differentiates an actuation by differences: dtau_dx, dtau_du. Mtau is the pseudoinverse of dtau_du; singular values
/// within the accuracy of the differences count as zero.
class ActuationModelNumDiff : public ActuationModelAbstract, public NumDiffOf<ActuationModelAbstract> {
 public:
  /// model: the actuation to differentiate.
  explicit ActuationModelNumDiff(std::shared_ptr<ActuationModelAbstract> model)
      : ActuationModelAbstract(internal::given("ActuationModelNumDiff", model)->get_state(), model->get_nu()),
        NumDiffOf("ActuationModelNumDiff", model) {}
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override { evaluate(data, x, &u); }
  void calc(const DataPtr& data, const ConstVectorRef& x) override { evaluate(data, x, nullptr); }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    differentiate(data, x, u, false);
  }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) override { differentiate(data, x, {}, true); }
  void commands(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& tau) override;
  void torqueTransform(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  std::shared_ptr<ActuationDataAbstract> createData() override;

 private:
  void evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u);
  void differentiate(const DataPtr& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u, bool terminal);
};

/// Data of ActuationModelNumDiff.
struct ActuationDataNumDiff : ActuationDataAbstract {
  explicit ActuationDataNumDiff(const ActuationModelNumDiff* model);  // allocates the data
  std::shared_ptr<ActuationDataAbstract> data_0;
};

/// Differentiates a residual by differences: Rx, Ru.
class ResidualModelNumDiff : public ResidualModelAbstract,
                             public NumDiffOf<ResidualModelAbstract>,
                             public internal::Reevaluation {
 public:
  /// model: the residual to differentiate.
  explicit ResidualModelNumDiff(const std::shared_ptr<ResidualModelAbstract>& model)
      : ResidualModelAbstract(internal::given("ResidualModelNumDiff", model)->get_state(), model->get_nr(),
                              model->get_nu(), model->get_q_dependent(), model->get_v_dependent(),
                              model->get_u_dependent()),
        NumDiffOf("ResidualModelNumDiff", model) {}
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override { evaluate(data, x, &u); }
  void calc(const DataPtr& data, const ConstVectorRef& x) override { evaluate(data, x, nullptr); }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    differences_of(data, x, u, false);
  }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) override { differences_of(data, x, unone_, true); }
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;

 private:
  void evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u);
  void differences_of(const DataPtr& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u, bool terminal);
};

/// Data of ResidualModelNumDiff.
struct ResidualDataNumDiff : ResidualDataAbstract {
  /// Allocates the data of the model.
  ResidualDataNumDiff(const ResidualModelNumDiff* model, DataCollector* collector)
      : ResidualDataAbstract(model, collector), data_0(model->get_model()->createData(collector)) {}
  std::shared_ptr<ResidualDataAbstract> data_0;
};

/// The common base of parts that are differentiated by differences outside of an action model.
template <class Model, class Data>
class PartNumDiff : public NumDiffOf<Model>, public internal::Reevaluation {
 public:
  /// Evaluates the model.
  void calc(const std::shared_ptr<Data>& data, const ConstVectorRef& x, const ConstVectorRef& u) {
    model_->calc(data, x, u);
  }
  /// Evaluates the model in a terminal node.
  void calc(const std::shared_ptr<Data>& data, const ConstVectorRef& x) { model_->calc(data, x); }
  /// Computes the derivatives by central differences.
  void calcDiff(const std::shared_ptr<Data>& data, const ConstVectorRef& x, const ConstVectorRef& u) {
    differentiate(data, x, u, false);
  }
  /// Computes central differences in a terminal node.
  void calcDiff(const std::shared_ptr<Data>& data, const ConstVectorRef& x) {
    differentiate(data, x, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(get_nu())), true);
  }
  /// Returns the state that the model was made for.
  const std::shared_ptr<StateAbstract>& get_state() const { return model_->get_state(); }
  std::size_t get_nu() const { return model_->get_nu(); }  // number of controls

 protected:
  /// name: the name of the class, for messages.
  PartNumDiff(const char* name, const std::shared_ptr<Model>& model) : NumDiffOf<Model>(name, model), name_(name) {}
  using NumDiffOf<Model>::model_;

 private:
  virtual Eigen::VectorXd values(const Data& data) const = 0;  // the numbers that are differentiated
  /// Stores the derivatives of `values` in data. by_u is null in a terminal node.
  virtual void store(const Eigen::MatrixXd& by_x, const Eigen::MatrixXd* by_u, Data& data) const = 0;
  void differentiate(const std::shared_ptr<Data>& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u,
                     bool terminal) const;
  const char* name_;
};

/// Differentiates a cost by differences: Lx, Lu. Hessians are Gauss-Newton's, from differences of the residual.
class CostModelNumDiff : public PartNumDiff<CostModelAbstract, CostDataAbstract> {
 public:
  /// model: the cost to differentiate.
  explicit CostModelNumDiff(const std::shared_ptr<CostModelAbstract>& model) : PartNumDiff("CostModelNumDiff", model) {}
  std::shared_ptr<CostDataAbstract> createData(DataCollector* shared);  // creates standalone data
  bool get_with_gauss_approx() const { return true; }                   // whether Hessians are Gauss-Newton's

 private:
  Eigen::VectorXd values(const CostDataAbstract& data) const override;
  void store(const Eigen::MatrixXd& by_x, const Eigen::MatrixXd* by_u, CostDataAbstract& data) const override;
};

/// Differentiates a constraint by differences: Gx, Gu, Hx, Hu.
class ConstraintModelNumDiff : public PartNumDiff<ConstraintModelAbstract, ConstraintDataAbstract> {
 public:
  /// model: the constraint to differentiate.
  explicit ConstraintModelNumDiff(const std::shared_ptr<ConstraintModelAbstract>& model)
      : PartNumDiff("ConstraintModelNumDiff", model) {}
  /// Creates data of this model; one per thread.
  std::shared_ptr<ConstraintDataAbstract> createData(DataCollector* shared) { return model_->createData(shared); }

 private:
  Eigen::VectorXd values(const ConstraintDataAbstract& data) const override;
  void store(const Eigen::MatrixXd& by_x, const Eigen::MatrixXd* by_u, ConstraintDataAbstract& data) const override;
};

/// Differentiates a contact by differences: da0_dx, at the motion that the reevaluations (set_reevals) compute.
class ContactModelNumDiff : public NumDiffOf<ContactModelAbstract>, public internal::Reevaluation {
 public:
  /// model: the contact to differentiate.
  explicit ContactModelNumDiff(const std::shared_ptr<ContactModelAbstract>& model)
      : NumDiffOf("ContactModelNumDiff", model) {}
  /// Evaluates the model.
  void calc(const std::shared_ptr<ContactDataAbstract>& data, const ConstVectorRef& x) { model_->calc(data, x); }
  /// Computes the derivatives by central differences.
  void calcDiff(const std::shared_ptr<ContactDataAbstract>& data, const ConstVectorRef& x);
  /// Creates data of this model; one per thread.
  std::shared_ptr<ContactDataAbstract> createData(MultibodyData* data) { return model_->createData(data); }
};

}  // namespace manycontact
