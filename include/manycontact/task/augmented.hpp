#pragma once
// Hard constraints by an augmented Lagrangian (Bertsekas, Constrained Optimization and Lagrange Multiplier Methods,
// 1982, chapters 2 and 3). A node's rows c = [g; h], within [lb, ub] (of h: 0), with multipliers m and penalty rho, add
//
//     rho/2 |z - P(z)|^2 - |m|^2 / (2 rho),    z = c + m / rho,  P(z) = min(max(z, lb), ub)
//
// to its cost. The gradient is C^T rho (z - P(z)), the Hessian Gauss-Newton's, rho C^T C of the rows where z is
// outside; the multipliers of the next round are m = rho (z - P(z)).

#include "manycontact/control/shooting.hpp"

namespace manycontact {

class ActionModelAugmented : public ActionModelAbstract {
 public:
  ActionModelAugmented(std::shared_ptr<ActionModelAbstract> inner, bool terminal);

  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  std::shared_ptr<ActionDataAbstract> createData() override;

  const std::shared_ptr<ActionModelAbstract>& get_inner() const { return inner_; }
  /// The largest |c - P(c)| at the data's last calc.
  double violation(const ActionDataAbstract& data) const;
  /// Multipliers by the data's last calc.
  void update_multipliers(const ActionDataAbstract& data);
  double get_penalty() const { return penalty_; }
  void set_penalty(double penalty) { penalty_ = penalty; }
  const Eigen::VectorXd& get_multipliers() const { return multipliers_; }

 private:
  void add_cost(ActionDataAbstract& data) const;
  void add_derivatives(ActionDataAbstract& data, bool with_u) const;
  std::shared_ptr<ActionModelAbstract> inner_;
  Eigen::VectorXd lower_, upper_, multipliers_;  // of c
  double penalty_ = 1;
};

struct ActionDataAugmented : ActionDataAbstract {
  explicit ActionDataAugmented(ActionModelAugmented* model);

  std::shared_ptr<ActionDataAbstract> inner;
  Eigen::VectorXd c, outside;  // by calc: [g; h], rho (z - P(z))
  Eigen::MatrixXd Cx, Cu;      // by calcDiff: of the rows outside, zero of the others
};

/// The same problem with augmented nodes, each with multipliers of its own.
std::shared_ptr<ShootingProblem> augmented(const ShootingProblem& problem);

}  // namespace manycontact
