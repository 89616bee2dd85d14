#pragma once
// An action model whose derivatives are central differences of another model. It is meant for user-defined models, and
// for tests.

#include "manycontact/control/action_model.hpp"

namespace manycontact {

class ActionModelNumDiff : public ActionModelAbstract {  // A node with derivatives by central differences.
 public:
  /// with_gauss_approx: Hessians are Rx^T Rx, ... of the residuals, which is right for costs 1/2 |r|^2. Otherwise they
  /// are second differences of the cost.
  explicit ActionModelNumDiff(std::shared_ptr<ActionModelAbstract> model, bool with_gauss_approx = false);

  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  std::shared_ptr<ActionDataAbstract> createData() override;
  void quasiStatic(const std::shared_ptr<ActionDataAbstract>& data, VectorRef u, const ConstVectorRef& x,
                   std::size_t maxiter = 100, double tol = 1e-9) override;

  const std::shared_ptr<ActionModelAbstract>& get_model() const { return model_; }  // the model that is differentiated
  /// The step of the differences: absolute in x's tangent space, relative to max(1, |u_i|) in u.
  double get_disturbance() const { return step_; }
  void set_disturbance(double disturbance);              // throws std::invalid_argument unless it is positive
  bool get_with_gauss_approx() const { return gauss_; }  // whether Hessians are Gauss-Newton's

  std::size_t get_nr() const override { return model_->get_nr(); }
  std::size_t get_ng() const override { return model_->get_ng(); }
  std::size_t get_nh() const override { return model_->get_nh(); }
  std::size_t get_ng_T() const override { return model_->get_ng_T(); }
  std::size_t get_nh_T() const override { return model_->get_nh_T(); }
  const Eigen::VectorXd& get_g_lb() const override { return model_->get_g_lb(); }
  const Eigen::VectorXd& get_g_ub() const override { return model_->get_g_ub(); }
  const Eigen::VectorXd& get_g_lb_T() const override { return model_->get_g_lb_T(); }
  const Eigen::VectorXd& get_g_ub_T() const override { return model_->get_g_ub_T(); }
  void print(std::ostream& os) const override;

 private:
  void differentiate(const std::shared_ptr<ActionDataAbstract>& data, const Eigen::VectorXd& x,
                     const Eigen::VectorXd& u, bool terminal);
  std::shared_ptr<ActionModelAbstract> model_;
  bool gauss_;
  double step_;
};

struct ActionDataNumDiff : ActionDataAbstract {           // Data of ActionModelNumDiff.
  explicit ActionDataNumDiff(ActionModelNumDiff* model);  // allocates the data of the model
  std::shared_ptr<ActionDataAbstract> data_0, data_step;  // of the model, at the point and at a displaced point
  Eigen::MatrixXd Rx, Ru;                                 // nr x ndx, nr x nu
};

}  // namespace manycontact
