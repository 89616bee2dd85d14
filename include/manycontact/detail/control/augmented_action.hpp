#pragma once
// A node with constraints c = [g; h], lo <= c <= hi (for h: lo = hi = 0), which become part of its cost l. With
// multipliers y and a penalty rho > 0, the cost is the augmented Lagrangian
//
//     l + rho/2 |z - P(z)|^2 - |y|^2 / (2 rho),    z = c + y / rho,    P the projection onto [lo, hi]
//
// (Nocedal & Wright, Numerical Optimization, 17.4; Rockafellar, SIAM J. Control 12, 1974). With C = dc/d(x, u), the
// gradient of this cost is the gradient of l plus C^T y+,
//
//     y+ = rho (z - P(z)) = max(y + rho (c - hi), 0) + min(y + rho (c - lo), 0).
//
// The Hessian is that of l plus rho C_A^T C_A; the curvature of c is left out (Gauss-Newton). The active rows A of C
// are equalities, and rows with y+ /= 0. The node itself then has no constraints, so that every solver accepts it.

#include "manycontact/control/action_model.hpp"

namespace manycontact {

struct ActionDataAugmentedLagrangian;

/// A node whose constraints are part of its cost.
class ActionModelAugmentedLagrangian
    : public NodeWithData<ActionModelAugmentedLagrangian, ActionModelAbstract, ActionDataAugmentedLagrangian> {
 public:
  static constexpr const char* kName = "ActionModelAugmentedLagrangian";

  /// Makes the node from a model with constraints. Throws std::invalid_argument for a null pointer.
  explicit ActionModelAugmentedLagrangian(std::shared_ptr<ActionModelAbstract> model);
  std::shared_ptr<ActionDataAbstract> createData() override { return createData(model_->createData()); }
  /// Creates data from existing data of the original model, which this node evaluates.
  std::shared_ptr<ActionDataAbstract> createData(std::shared_ptr<ActionDataAbstract> inner);
  bool checkData(const DataPtr& data) override;
  void quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter = 100,
                   double tol = 1e-9) override;
  void print(std::ostream& os) const override { os << kName << " {penalty=" << rho_ << ", " << *model_ << "}"; }

  const std::shared_ptr<ActionModelAbstract>& get_model() const { return model_; }  // the original model
  /// Returns the multipliers y of [g; h], in a terminal node those of its terminal constraints. They are initially
  /// zeros. calc throws std::invalid_argument if their number differs from the number of constraints.
  const Eigen::VectorXd& get_multipliers() const { return y_; }
  double get_penalty() const { return rho_; }                 // initially 10
  void set_multipliers(const Eigen::VectorXd& y) { y_ = y; }  // see get_multipliers
  void set_penalty(double rho);                               // rho > 0; otherwise throws std::invalid_argument
  /// Returns whether the cost contains l, the original node's cost; initially true. If false, with y = 0 and rho = 1,
  /// the cost is half the squared violation.
  bool get_with_cost() const { return with_cost_; }
  void set_with_cost(bool with_cost) { with_cost_ = with_cost; }  // see get_with_cost

 private:
  void evaluate(ActionDataAugmentedLagrangian& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void differentiate(ActionDataAugmentedLagrangian& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  std::shared_ptr<ActionModelAbstract> model_;
  Eigen::VectorXd y_;
  double rho_ = 10;
  bool with_cost_ = true;
};

struct ActionDataAugmentedLagrangian : ActionDataAbstract {  // Data of ActionModelAugmentedLagrangian.
  /// Allocates the data of the model. inner: data of the original model; null: new data are created.
  explicit ActionDataAugmentedLagrangian(ActionModelAugmentedLagrangian* model,
                                         std::shared_ptr<ActionDataAbstract> inner = nullptr);
  std::shared_ptr<ActionDataAbstract> inner;  // data of the original model
  Eigen::VectorXd y_next;                     // y+: the multiplier update, set by calc
  std::vector<double> panel, product;         // P: rows sqrt(rho) [dc/du dc/dx] of active rows; P^T P
};

}  // namespace manycontact
