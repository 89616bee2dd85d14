#pragma once
// A node of an optimal control problem in discrete time,
//
//     x' = f(x, u),    cost l(x, u),    g_lb <= g(x, u) <= g_ub,    h(x, u) = 0,
//
// or a terminal node, where cost and constraints depend on x alone. The interface is that of Crocoddyl's
// ActionModelAbstract. Derivatives are on the tangent space of states: Fx is ndx x ndx.

#include "manycontact/action/diff_action.hpp"

namespace manycontact {

class ActionModelAbstract;

struct WithoutMatrices {};

/// The results of a node. Sizes are those of the model.
struct ActionDataAbstract {
  explicit ActionDataAbstract(const ActionModelAbstract* model);  // allocates the data of the model
  /// Leaves the derivatives' matrices empty, for classes of data that store derivatives in another form.
  ActionDataAbstract(const ActionModelAbstract* model, WithoutMatrices);
  virtual ~ActionDataAbstract() = default;

  double cost = 0;                // set by calc
  Eigen::VectorXd xnext;          // nx: set by calc
  Eigen::MatrixXd Fx, Fu;         // ndx x ndx, ndx x nu: set by calcDiff
  Eigen::VectorXd r;              // nr: set by calc
  Eigen::VectorXd Lx, Lu;         // ndx, nu: set by calcDiff
  Eigen::MatrixXd Lxx, Lxu, Luu;  // ndx x ndx, ndx x nu, nu x nu: set by calcDiff
  Eigen::VectorXd g, h;           // ng, nh (in a terminal node ng_T, nh_T): set by calc
  Eigen::MatrixXd Gx, Gu;         // ng x ndx, ng x nu: set by calcDiff
  Eigen::MatrixXd Hx, Hu;         // nh x ndx, nh x nu: set by calcDiff

  /// Returns false if the matrices above are empty, because the derivatives are stored in another form. This applies to
  /// IntegratedActionModelEuler with storage kPanel, and to ActionModelParts with kSparse.
  virtual bool has_matrices() const { return true; }
  /// pull_back computes gx = Fx^T p and gu = Fu^T p for p (ndx). `dynamics` copies Fx to fx and Fu to fu. Both use the
  /// last calcDiff, and throw std::logic_error if only the subproblems' data contain derivatives.
  virtual void pull_back(const Eigen::VectorXd& p, VectorRef gx, VectorRef gu) const;
  virtual void dynamics(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const;

 protected:
  void allocate_matrices(const ActionModelAbstract* model);  // allocates the derivatives
};

class ActionModelAbstract : public NodeOf<ActionDataAbstract> {  // A node in discrete time.
 public:
  using ActionDataAbstract = manycontact::ActionDataAbstract;

  /// Throws std::invalid_argument for null pointers and numbers out of range.
  ActionModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nu, std::size_t nr = 0, std::size_t ng = 0,
                      std::size_t nh = 0, std::size_t ng_T = 0, std::size_t nh_T = 0)
      : NodeOf("ActionModel", std::move(state), nu, nr, ng, nh, ng_T, nh_T) {}

  DataPtr createData() override { return std::make_shared<ActionDataAbstract>(this); }
  void quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter = 100,
                   double tol = 1e-9) override;
};

}  // namespace manycontact
