#pragma once
// A numerical twin of a differential action model: its derivatives by central differences. For users' own models, and
// for tests.

#include "manycontact/action/diff_action.hpp"

namespace manycontact {

class DifferentialActionModelNumDiff : public DifferentialActionModelAbstract {  // by differences
 public:
  /// with_gauss_approx: Hessians Rx^T Rx, ... of the stacked residuals, right for costs 1/2 |r|^2 of weight 1;
  /// otherwise second differences of the cost.
  explicit DifferentialActionModelNumDiff(std::shared_ptr<DifferentialActionModelAbstract> model,
                                          bool with_gauss_approx = false);

  void calc(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x) override;
  /// Fx, Fu, Lx, Lu, Gx, Gu, Hx, Hu and the Hessians, dense only.
  void calcDiff(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x) override;
  std::shared_ptr<DifferentialActionDataAbstract> createData() override;
  void quasiStatic(const std::shared_ptr<DifferentialActionDataAbstract>& data, VectorRef u, const ConstVectorRef& x,
                   std::size_t maxiter = 100, double tol = 1e-9) override;

  const std::shared_ptr<DifferentialActionModelAbstract>& get_model() const { return model_; }
  /// The step, absolute in x's tangent, relative to max(1, |u_i|) in u.
  double get_disturbance() const { return step_; }
  void set_disturbance(double disturbance);
  bool get_with_gauss_approx() const { return gauss_; }

  std::size_t get_nr() const override { return model_->get_nr(); }
  std::size_t get_ng() const override { return model_->get_ng(); }
  std::size_t get_nh() const override { return model_->get_nh(); }
  std::size_t get_ng_T() const override { return model_->get_ng_T(); }
  std::size_t get_nh_T() const override { return model_->get_nh_T(); }
  const Eigen::VectorXd& get_g_lb() const override { return model_->get_g_lb(); }
  const Eigen::VectorXd& get_g_ub() const override { return model_->get_g_ub(); }
  const Eigen::VectorXd& get_g_lb_T() const override { return model_->get_g_lb_T(); }
  const Eigen::VectorXd& get_g_ub_T() const override { return model_->get_g_ub_T(); }
  /// Of the model.
  void set_g_lb(const Eigen::VectorXd& g_lb) override { model_->set_g_lb(g_lb); }
  void set_g_ub(const Eigen::VectorXd& g_ub) override { model_->set_g_ub(g_ub); }
  void print(std::ostream& os) const override;

 private:
  void differentiate(const std::shared_ptr<DifferentialActionDataAbstract>& data, const Eigen::VectorXd& x,
                     const Eigen::VectorXd& u, bool terminal);
  std::shared_ptr<DifferentialActionModelAbstract> model_;
  bool gauss_;
  double step_;
};

struct DifferentialActionDataNumDiff : DifferentialActionDataAbstract {  // of the twin
  explicit DifferentialActionDataNumDiff(DifferentialActionModelNumDiff* model);
  std::shared_ptr<DifferentialActionDataAbstract> data_0;     // of the model, at the point
  std::shared_ptr<DifferentialActionDataAbstract> data_step;  // of the model, beside it
  Eigen::MatrixXd Rx, Ru;                                     // nr x ndx, nr x nu
};

}  // namespace manycontact
