#pragma once
// A node whose constraints c = [g; h], lo <= c <= hi (of h: 0 <= h <= 0), became part of its cost: with multipliers y
// and the penalty rho > 0,
//
//     l + rho/2 |z - P(z)|^2 - |y|^2 / (2 rho),    z = c + y / rho,    P the projection onto [lo, hi],
//
// the augmented Lagrangian (Nocedal & Wright, Numerical Optimization, 17.4; Rockafellar, SIAM J. Control 12, 1974).
// With C = dc/d(x, u) its gradient is that of l plus C^T y+,
//
//     y+ = rho (z - P(z)) = max(y + rho (c - hi), 0) + min(y + rho (c - lo), 0),
//
// and its Hessian, with curvature of c left out (Gauss-Newton), that of l plus rho C_A^T C_A; rows A are those with
// y+ /= 0, and equalities. The node itself has no constraints, so that every solver takes it.

#include "manycontact/control/action_model.hpp"

namespace manycontact {

class ActionModelAugmentedLagrangian : public ActionModelAbstract {  // a node with its constraints in its cost
 public:
  explicit ActionModelAugmentedLagrangian(std::shared_ptr<ActionModelAbstract> model);

  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  std::shared_ptr<ActionDataAbstract> createData() override;
  /// Around data of the model, which are evaluated with it.
  std::shared_ptr<ActionDataAbstract> createData(std::shared_ptr<ActionDataAbstract> inner);
  bool checkData(const std::shared_ptr<ActionDataAbstract>& data) override;
  void quasiStatic(const std::shared_ptr<ActionDataAbstract>& data, VectorRef u, const ConstVectorRef& x,
                   std::size_t maxiter = 100, double tol = 1e-9) override;
  void print(std::ostream& os) const override;

  const std::shared_ptr<ActionModelAbstract>& get_model() const { return model_; }
  /// Of [g; h], in a terminal node of those that hold there; at first zeros. calc throws std::invalid_argument when
  /// there are not as many as constraints.
  const Eigen::VectorXd& get_multipliers() const { return y_; }
  double get_penalty() const { return rho_; }  // at first 10
  void set_multipliers(const Eigen::VectorXd& y) { y_ = y; }
  void set_penalty(double rho);  // > 0, or std::invalid_argument
  /// Whether the node's own cost counts, as at first. Without, y = 0 and rho = 1 the cost is half the squared
  /// violation.
  bool get_with_cost() const { return with_cost_; }
  void set_with_cost(bool with_cost) { with_cost_ = with_cost; }

 private:
  void add_values(ActionDataAbstract& data, bool terminal) const;
  void add_derivatives(ActionDataAbstract& data, bool terminal) const;
  std::shared_ptr<ActionModelAbstract> model_;
  Eigen::VectorXd y_;
  double rho_ = 10;
  bool with_cost_ = true;
};

struct ActionDataAugmentedLagrangian : ActionDataAbstract {  // of such a node
  ActionDataAugmentedLagrangian(ActionModelAugmentedLagrangian* model, std::shared_ptr<ActionDataAbstract> inner);
  std::shared_ptr<ActionDataAbstract> inner;  // of the model
  Eigen::VectorXd y_next;                     // y+: by calc
  std::vector<double> panel, product;         // sqrt(rho) [C_A of u, of x] by rows, its square
};

}  // namespace manycontact
